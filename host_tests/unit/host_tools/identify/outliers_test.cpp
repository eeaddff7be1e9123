#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A thousand samples that scatter evenly from -1 to 1, plus what `added` gives for each.
template <class Added>
std::vector<std::size_t> outliers_with(Added added) {
  std::mt19937_64 random{19};
  RestSamples samples{.axis_count = 1};
  for (std::int64_t k = 0; k < 1'000; ++k) {
    const double noise = static_cast<double>(random() % 2'001) / 1'000.0 - 1.0;
    samples.time.push_back(core::Instant::from_ns(k * 10'000'000));
    samples.rate_rad_s.push_back({static_cast<float>(noise + added(k))});
  }
  return find_outliers(samples);
}

TEST(OutlierRun, IsFoundWhereTheSamplesNextToItAreCalm) {
  EXPECT_THAT(outliers_with([](std::int64_t k) { return k == 500 ? 100.0 : 0.0; }),
              ElementsAre(500U));
  EXPECT_THAT(outliers_with([](std::int64_t k) { return k >= 500 && k < 503 ? -100.0 : 0.0; }),
              ElementsAre(500U, 501U, 502U));
}

TEST(OutlierRun, IsGenuineAmidASwingOfSixSamples) {
  const auto swing = [](std::int64_t k) {
    if (k == 500) return 100.0;
    if (k < 494 || k > 506) return 0.0;
    return k % 2 == 0 ? 8.0 : -8.0;
  };
  EXPECT_THAT(outliers_with(swing), IsEmpty());
}

TEST(OutlierRun, IsFoundAwayFromASwing) {
  const auto swing_before = [](std::int64_t k) {
    if (k == 500) return 100.0;
    if (k < 470 || k > 482) return 0.0;
    return k % 2 == 0 ? 8.0 : -8.0;
  };
  EXPECT_THAT(outliers_with(swing_before), ElementsAre(500U));
}

TEST(OutlierRun, HasFiveSamplesAtMost) {
  EXPECT_THAT(outliers_with([](std::int64_t k) { return k >= 500 && k < 506 ? 100.0 : 0.0; }),
              IsEmpty());
}

}  // namespace
}  // namespace zerorate::identify

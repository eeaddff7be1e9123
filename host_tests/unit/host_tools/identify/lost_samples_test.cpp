#include "host_tools/lib/identify/lost_samples.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

namespace zerorate::identify {
namespace {

/// Stamps of a sensor at 100 Hz without every sample that draws a number below `lost_of_1000`; the
/// share that went is counted.
struct ThinnedTrain {
  ThinnedTrain(std::int64_t samples, std::uint64_t lost_of_1000) {
    std::mt19937_64 random{17};
    for (std::int64_t k = 0; k < samples; ++k) {
      if (random() % 1000 >= lost_of_1000) times.push_back(core::Instant::from_ns(k * 10'000'000));
    }
    lost = 1.0 - static_cast<double>(times.size()) / static_cast<double>(samples);
  }

  std::vector<core::Instant> times;
  double lost = 0.0;
};

TEST(LostShareOfAnEvenTrain, IsZero) {
  const LostShare share = lost_share(ThinnedTrain(100'000, 0).times, false);
  EXPECT_EQ(share.by_intervals, 0.0);
  EXPECT_EQ(share.by_unevenness, 0.0);
  EXPECT_EQ(share.mean_interval, core::Duration::milliseconds(10));
}

/// The unevenness is rather too small: the smallest of three estimates is taken.
TEST(LostShare, IsTheShareOfTheSamplesThatWentMissing) {
  for (const std::uint64_t lost_of_1000 : {50U, 150U, 300U}) {
    const ThinnedTrain train(400'000, lost_of_1000);
    const LostShare share = lost_share(train.times, false);
    EXPECT_NEAR(share.by_intervals, train.lost, 0.01);
    EXPECT_GT(share.by_unevenness, 0.6 * train.lost);
    EXPECT_LT(share.by_unevenness, 1.2 * train.lost);
    EXPECT_GT(share.most_by_unevenness, share.by_unevenness);
    EXPECT_LE(share.certain(), share.by_intervals);
    EXPECT_LE(share.certain(), share.most_by_unevenness);
  }
}

TEST(LostShareOfSharedStamps, IsThatOfTheLongestBlocks) {
  const ThinnedTrain train(400'000, 200);
  const LostShare share = lost_share(train.times, true);
  EXPECT_EQ(share.by_intervals, 0.0) << "the reader made the intervals";
  EXPECT_NEAR(share.by_unevenness, train.lost, 0.3 * train.lost);
}

TEST(LostShareOfAJitteryClock, IsNearZero) {
  std::mt19937_64 random{18};
  std::vector<core::Instant> times;
  for (std::int64_t k = 0; k < 100'000; ++k) {
    const auto late_ns = static_cast<std::int64_t>(random() % 4'000'000);
    times.push_back(core::Instant::from_ns(k * 10'000'000 + late_ns));
  }
  EXPECT_LT(lost_share(times, false).certain(), 0.01);
}

TEST(LostShareOfAShortRecording, IsNotJudged) {
  const std::vector<core::Instant> times = ThinnedTrain(2'700, 300).times;
  ASSERT_LE(times.size(), 2'048U);
  EXPECT_EQ(lost_share(times, false).by_unevenness, 0.0);
  EXPECT_GT(lost_share(times, true).by_unevenness, 0.0) << "1024 are enough there";
}

}  // namespace
}  // namespace zerorate::identify

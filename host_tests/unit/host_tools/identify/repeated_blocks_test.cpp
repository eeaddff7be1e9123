#include "host_tools/lib/identify/repeated_blocks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <random>

namespace zerorate::identify {
namespace {

using ::testing::HasSubstr;

/// Noise of one axis at 100 Hz in steps, of which row k is that of source(k).
template <class Source>
RestSamples samples_of(std::size_t rows, float step, Source source) {
  std::mt19937 random{3};
  std::normal_distribution<float> normal;
  std::vector<float> noise(rows);
  for (float& rate : noise) rate = step * std::round(normal(random) / step);
  RestSamples samples{.axis_count = 1};
  for (std::size_t k = 0; k < rows; ++k) {
    samples.time.push_back(core::Instant::from_ns(static_cast<std::int64_t>(k) * 10'000'000));
    samples.rate_rad_s.push_back({noise[source(k)], 0.0F, 0.0F});
  }
  return samples;
}

constexpr float kFine = 1e-3F;

TEST(RepeatedBlocks, AreNoneInNoise) {
  const auto itself = [](std::size_t k) { return k; };
  for (const float step : {kFine, 0.2F, 1.0F, 3.0F})
    EXPECT_FALSE(doubt_of_repeated_blocks(samples_of(60'000, step, itself))) << step;
}

TEST(RepeatedBlocks, OfABufferThatComesAgainAreCertain) {
  const auto ever = samples_of(60'000, kFine, [](std::size_t k) { return k % 100; });
  const auto found = doubt_of_repeated_blocks(ever);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->is_certain);
  EXPECT_THAT(found->sentence, HasSubstr("59900 rows (1e+02 %)"));
  EXPECT_THAT(found->sentence, HasSubstr("begin at 1 s, 100 rows behind"));
  const auto twice =
      samples_of(60'000, kFine, [](std::size_t k) { return k / 200 * 100 + k % 100; });
  ASSERT_TRUE(doubt_of_repeated_blocks(twice));
  EXPECT_THAT(doubt_of_repeated_blocks(twice)->sentence, HasSubstr("30000 rows (50 %)"));
}

TEST(RepeatedBlocks, AreFoundInCoarseSteps) {
  const auto twice = [](std::size_t k) { return k / 1'000 * 500 + k % 500; };
  EXPECT_TRUE(doubt_of_repeated_blocks(samples_of(60'000, 0.5F, twice)));
}

TEST(RepeatedBlock, AloneIsARemark) {
  const auto once = [](std::size_t k) { return k >= 30'000 && k < 30'100 ? k - 100 : k; };
  const auto found = doubt_of_repeated_blocks(samples_of(60'000, kFine, once));
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->is_certain);
  EXPECT_THAT(found->sentence, HasSubstr("100 rows (0.17 %)"));
  EXPECT_THAT(found->sentence, HasSubstr("begin at 300 s, 100 rows behind"));
}

}  // namespace
}  // namespace zerorate::identify

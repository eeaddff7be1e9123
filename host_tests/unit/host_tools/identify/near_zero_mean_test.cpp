#include "host_tools/lib/identify/near_zero_mean.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace zerorate::identify {
namespace {

using ::testing::HasSubstr;

/// White noise on three axes about biases, of which the mean of the block before is taken off where
/// blocks are given. A block is a share of the whole.
RestSamples noise(std::size_t size, std::size_t blocks) {
  std::mt19937_64 random{51};
  std::normal_distribution<float> normal{0.0F, 1e-3F};
  constexpr std::array<float, 3> kBias_rad_s{4e-3F, -6e-3F, 5e-3F};
  RestSamples samples;
  std::array<double, 3> sums{};
  std::array<float, 3> taken_off{};
  const std::size_t block = blocks == 0 ? size + 1 : size / blocks;
  for (std::size_t k = 0; k < size; ++k) {
    std::array<float, 3> rates{};
    for (std::size_t i = 0; i < 3; ++i) {
      const float rate = kBias_rad_s[i] + normal(random);
      if (k % block == 0 && k > 0) {
        taken_off[i] = static_cast<float>(sums[i] / static_cast<double>(block));
        sums[i] = 0.0;
      }
      sums[i] += double{rate};
      rates[i] = rate - (k < block && blocks > 0 ? kBias_rad_s[i] : taken_off[i]);
    }
    samples.time.push_back(core::Instant::from_ns(static_cast<std::int64_t>(k) * 10'000'000));
    samples.rate_rad_s.push_back(rates);
  }
  return samples;
}

std::vector<RestDoubt> doubts_as_samples_come(const RestSamples& samples) {
  LevelCheck check{3};
  for (const auto& rates : samples.rate_rad_s) check.add(rates);
  return check.doubts();
}

TEST(LevelsThatAreTakenAsTheyCome, AreThoseOfAllSamples) {
  for (const std::size_t size : {8'000U, 100'000U}) {
    const RestSamples compensated = noise(size, 400);
    const auto doubts = doubts_as_samples_come(compensated);
    ASSERT_EQ(doubts.size(), 1U) << size;
    EXPECT_EQ(doubts.front().name, doubt::kBias);
    EXPECT_THAT(doubts.front().sentence, HasSubstr("every axis is near zero"));
    EXPECT_EQ(doubts_of_bias_taken_out(compensated).size(), 1U);
    EXPECT_TRUE(doubts_as_samples_come(noise(size, 0)).empty()) << "a gyro with its biases";
  }
}

TEST(LevelsOfFewSamples, AreInNoDoubt) {
  EXPECT_TRUE(doubts_as_samples_come(noise(150, 10)).empty());
}

}  // namespace
}  // namespace zerorate::identify

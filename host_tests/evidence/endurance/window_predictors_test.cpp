/// @file
/// Sums that are kept over years of ticks.

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/suffix_sums.hpp"
#include "host_tests/support/sample_modes.hpp"

namespace zerorate::core {
namespace {

TEST(CalibrationMeanOverTenMillionTicks, LosesNothingToRounding) {
  const auto modes = testing::mixed_modes(Start::stationary);
  CalibrationMean mean{modes};
  double sum = 0.0;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.2F, 0.3F);
  for (int k = 0; k < 10'000'000; ++k) {
    const float rate = uniform(random);
    sum += double{rate};
    mean.observe(rate, 1.0F);
  }
  EXPECT_NEAR(double{mean.bias_rad_s(modes.over(1))}, sum / 1e7, 1e-7);
}

TEST(SuffixSumsOfAHundredMillion, CountEveryMeasurement) {
  SuffixSums<> sums;
  constexpr std::uint32_t kMany = 110'000'000;  // more than the rings hold: the oldest swallows
  for (std::uint32_t k = 0; k < kMany; ++k) sums.push(1.0F);
  EXPECT_EQ(sums.count(), kMany);
  EXPECT_FLOAT_EQ(sums.sum_of_newest(kMany), 1.1e8F);
  EXPECT_FLOAT_EQ(sums.sum_of_newest(kMany / 3), static_cast<float>(kMany / 3));
}

}  // namespace
}  // namespace zerorate::core

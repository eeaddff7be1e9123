#include "host_tools/lib/identify/rounding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using ::testing::HasSubstr;

/// Normal values about a mean, rounded to whole numbers.
double variance_by_hand(double mean, double sigma) {
  std::mt19937_64 random{31};
  std::normal_distribution<double> normal{mean, sigma};
  constexpr int kCount = 200'000;
  double sum = 0.0;
  double squares = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const double value = std::round(normal(random));
    sum += value;
    squares += value * value;
  }
  return squares / kCount - sum / kCount * (sum / kCount);
}

TEST(SigmaBeforeRounding, LiesInItsRangeForEveryMean) {
  for (const double sigma : {0.25, 0.35, 0.5, 0.9, 1.5}) {
    for (const double mean : {0.0, 0.2, 0.5, 0.8}) {
      const double variance = variance_by_hand(mean, sigma);
      // Four standard errors of a variance of 200,000 values: 1.3 %.
      const SigmaRange range = sigma_before_rounding(0.987 * variance, 1.013 * variance);
      EXPECT_LE(range.lo, sigma) << mean;
      EXPECT_GE(range.hi, 0.98 * sigma) << mean;  // 0.02: the grid of sigmas
    }
  }
}

TEST(SigmaBeforeRounding, IsShepardsAboveHalfAStep) {
  for (const double sigma : {0.7, 2.0, 10.0}) {
    const double variance = sigma * sigma + 1.0 / 12.0;
    const SigmaRange range = sigma_before_rounding(variance, variance);
    EXPECT_NEAR(range.lo, sigma, 0.02 * sigma);
    EXPECT_NEAR(range.hi, sigma, 0.02 * sigma);
  }
}

TEST(SigmaBeforeRounding, IsWideWhereTheStepsHideIt) {
  const double variance = variance_by_hand(0.2, 0.3);
  const SigmaRange range = sigma_before_rounding(variance, variance);
  EXPECT_GT(range.hi, 1.3 * range.lo);
}

/// Rates at 100 Hz in steps [deg/s], of white noise of one step a sample.
RestSamples rounded(double step_dps) {
  std::mt19937_64 random{32};
  std::normal_distribution<double> noise{0.3, 0.1};
  RestSamples samples{.axis_count = 1,
                      .sample_period = core::Duration::milliseconds(10),
                      .mean_period = core::Duration::milliseconds(10)};
  for (std::int64_t k = 0; k < 5'000; ++k) {
    const double rate = std::round(noise(random) / step_dps) * step_dps;
    samples.time.push_back(core::Instant::from_ns(k * 10'000'000));
    samples.rate_rad_s.push_back({static_cast<float>(rate * units::kRadPerDeg)});
  }
  return samples;
}

TEST(RoundedRates, HaveARemarkWhereRoundingIsPartOfN) {
  // 0.1 deg/s a sample at 100 Hz: 0.01 deg/s/sqrt(Hz), or 0.000175 rad/sqrt(s).
  const IntervalEstimate walk{.value = 1.75e-4, .lo = 1.74e-4, .hi = 1.76e-4};
  const auto coarse = remark_on_rounding(rounded(0.1), 0, walk);
  ASSERT_TRUE(coarse);
  EXPECT_THAT(*coarse, HasSubstr("steps of 0.1 deg/s"));
  // sqrt(1 - 1/12) = 0.957 of it.
  EXPECT_THAT(*coarse, HasSubstr("alone is 0.0095"));
  EXPECT_FALSE(remark_on_rounding(rounded(0.02), 0, walk));
}

}  // namespace
}  // namespace zerorate::identify

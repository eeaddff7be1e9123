// Variances of the filter: that of the bias that one drive has and others have not, and slopes.

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "core/heading/heading_filter.hpp"
#include "host_tests/unit/core/heading/known_source.hpp"

namespace zerorate::core {
namespace {

using Verdict = ReferenceVerdict;

/// Variance of the bias from drive to drive that a filter has learnt from some drives, which it
/// guessed to be 4e-3 deg/s squared.
float variance_learnt(float true_rad_s, int drives, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<float> bias{0.0F, 1.0F};
  HeadingFilter::Params params = kParams;
  params.between_drives_rad_s = 0.004F * kRadPerDeg;
  HeadingFilter filter = filter_of_honest_references(params);
  for (int k = 0; k < drives; ++k) {
    filter.depart(1e-12F);
    (void)filter.take_heading(0.0F, 1e-2F * kVariance, {});
    filter.advance({true_rad_s * bias(random) * 600.0F, 600.0F}, 0.0F, 1e-12F);
    EXPECT_EQ(filter.take_heading(0.0F, 1e-2F * kVariance, {}), Verdict::learnt);
    filter.lose_heading();
  }
  filter.depart(1e-12F);
  return filter.state().between_drives_rad2_s2;
}

TEST(HeadingVariances, LearnsHowMuchTheBiasDiffersFromDriveToDrive) {
  for (const float dps : {0.002F, 0.004F, 0.006F}) {
    const float true_rad_s = dps * kRadPerDeg;
    // The deviation of a variance of 32 drives is a quarter of it.
    const float found = variance_learnt(true_rad_s, 40, 12) / (true_rad_s * true_rad_s);
    EXPECT_GT(found, 0.4F) << dps;
    EXPECT_LT(found, 1.6F) << dps;
  }
}

TEST(HeadingVariances, LearnsFromTenDrivesThatTheBiasDoesNotDiffer) {
  const float guessed_rad_s = 0.004F * kRadPerDeg;
  // A reference errs by 0.05 deg, in 600 s by 1.2e-4 deg/s.
  EXPECT_LT(variance_learnt(0.0F, 10, 12), 0.01F * guessed_rad_s * guessed_rad_s);
}

TEST(HeadingVariances, HoldsTheBiasOfThisDriveInTheVarianceOfATurn) {
  HeadingFilter::Params params = kParams;
  params.between_drives_rad_s = 0.004F * kRadPerDeg;
  HeadingFilter filter{params};
  HeadingFilter::State state = filter.state();
  state.has_learnt = true;
  filter.restore(state);
  filter.depart(kBiasVariance);
  const float length_s = 100.0F;
  const float of_offset_rad = params.offset_rad_s * length_s;
  const float of_drive_rad = params.between_drives_rad_s * length_s;
  const float expected = of_offset_rad * of_offset_rad + of_drive_rad * of_drive_rad;
  EXPECT_NEAR(filter.turn_variance_rad2({0.0F, length_s}), expected, 1e-3F * expected);
  for (int k = 0; k < 100; ++k) filter.advance({0.0F, 1.0F}, 0.0F, kBiasVariance);
  EXPECT_NEAR(filter.driven_variance_rad2({0.0F, length_s}), expected, 1e-3F * expected);
  const float predicted = 1e-9F;
  const float of_rate = predicted + expected / (length_s * length_s);
  EXPECT_NEAR(filter.bias_variance_rad2_s2(predicted), of_rate, 1e-3F * of_rate);
}

// A filter that was followed for long no longer shows how its bias wanders.
TEST(HeadingVariances, LetsTheBiasWanderOnAsInTheFirstTwoMinutes) {
  constexpr float kGrowth = 1e-11F;  // growth of the variance in a second
  HeadingFilter filter = filter_of_known_source();
  filter.depart(kBiasVariance);
  float predicted = kBiasVariance;
  for (int second = 0; second < 600; ++second) {
    if (second < 130) predicted += kGrowth;
    filter.advance({0.0F, 1.0F}, 0.0F, predicted);
  }
  EXPECT_NEAR(filter.state().bias_prior_rad2_s2, kBiasVariance + 600.0F * kGrowth, 2.0F * kGrowth);
}

TEST(HeadingVariances, IsSurerOfATurnInWhichReferencesCame) {
  HeadingFilter filter = filter_of_honest_references(
      {.offset_rad_s = 0.0F, .between_drives_rad_s = 0.004F * kRadPerDeg});
  filter.depart(kBiasVariance);
  (void)filter.take_heading(0.0F, kVariance, {});
  for (int k = 0; k < 300; ++k) {
    filter.advance({0.0F, 1.0F}, 0.0F, kBiasVariance);
    (void)filter.take_heading(0.0F, kVariance, {});
  }
  // After t seconds the bias is known to sigma sqrt(12 / t^3), from 60 s on better than guessed:
  // 0.49 deg in all, where the guess makes 1.2 deg.
  const HeadingFilter::Turn whole{0.0F, 300.0F};
  EXPECT_LT(filter.driven_variance_rad2(whole), 0.3F * filter.turn_variance_rad2(whole));
}

TEST(HeadingVariances, TakesReferencesOnOneSlopeForOne) {
  constexpr float kSlope_rad2 = kVariance;
  HeadingFilter::Params params = kParams;
  params.slope_variance_rad2 = kSlope_rad2;
  HeadingFilter filter = filter_of_honest_references(params);
  filter.depart(1e-12F);
  const auto variance = [&] {
    return filter.state().covariance(HeadingFilter::kHeading, HeadingFilter::kHeading);
  };
  (void)filter.take_heading(0.0F, 1e-4F * kVariance, {});
  EXPECT_NEAR(variance(), kSlope_rad2, 0.01F * kSlope_rad2);
  for (int k = 0; k < 100; ++k) {
    filter.advance({0.0F, 0.1F}, 0.0F, 1e-12F);
    (void)filter.take_heading(0.0F, 1e-4F * kVariance, {});
  }
  // Two slopes in ten seconds: that of the begin, and that of the hundred references after it.
  EXPECT_NEAR(variance(), 0.5F * kSlope_rad2, 0.1F * kSlope_rad2);
}

TEST(HeadingVariances, HoldsTheSlopesAtBothEndsOfATurn) {
  HeadingFilter::Params params = kParams;
  params.slope_variance_rad2 = kVariance;
  const HeadingFilter filter{params};
  EXPECT_NEAR(filter.turn_variance_rad2({}), 2.0F * kVariance, 1e-3F * kVariance);
}

}  // namespace
}  // namespace zerorate::core

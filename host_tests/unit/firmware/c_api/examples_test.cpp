#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "firmware/c_api/examples/error_state_filter.hpp"
#include "firmware/c_api/examples/heading.h"
#include "host_tests/unit/firmware/c_api/c_api_rig.hpp"

namespace zerorate::c_api {
namespace {

using testing::feed;
using testing::kDriveSamples;
using testing::kPeriod_s;
using testing::kStopSamples;
using testing::kTurn_rad_s;
using testing::Moment;
using testing::moment;

constexpr std::int64_t kCycle = kStopSamples + kDriveSamples;
constexpr std::int64_t kDrives = 5;
/// Sigma of the heading from the gyro's white noise alone, over all drives [rad].
double white_sigma_rad() {
  const double variance = static_cast<double>(front_gyro.white_variance_rad2_s2);
  return static_cast<double>(kPeriod_s) *
         std::sqrt(variance * static_cast<double>(kDrives * kDriveSamples));
}
constexpr double kTrueHeading_rad =
    static_cast<double>(kTurn_rad_s) * static_cast<double>(kPeriod_s) * (kDrives * kDriveSamples);

TEST(HeadingIntegrator, KeepsItsHeadingWithinItsSigma) {
  heading integrator{};
  ASSERT_EQ(heading_init(&integrator, &front_gyro), ZERORATE_OK);
  double uncorrected_rad = 0.0;
  for (std::int64_t k = 0; k < kDrives * kCycle; ++k) {
    const Moment now = moment(k);
    ASSERT_EQ(heading_step(&integrator, &now.measured, now.stands), ZERORATE_OK);
    if (!now.stands) uncorrected_rad += double{now.measured.rate_rad_s[2]} * double{kPeriod_s};
  }
  const double error_rad = double{integrator.heading_rad} - kTrueHeading_rad;
  // Four sigma of what the bias and the white noise leave; a float of 30 rad rounds to 2e-6.
  const double rounding_rad = 2e-6 * std::sqrt(static_cast<double>(kDrives * kDriveSamples));
  EXPECT_LT(std::abs(error_rad),
            4.0 * std::hypot(double{integrator.sigma_rad}, white_sigma_rad()) + rounding_rad);
  EXPECT_GT(std::abs(uncorrected_rad - kTrueHeading_rad), 1.0);
}

/// Nobody measured what was turned in a gap: the rate after it says nothing of it.
TEST(HeadingIntegratorAfterAGap, AddsNothingForIt) {
  heading integrator{};
  ASSERT_EQ(heading_init(&integrator, &front_gyro), ZERORATE_OK);
  for (std::int64_t k = 0; k < kStopSamples + 10; ++k) {
    const Moment now = moment(k);
    ASSERT_EQ(heading_step(&integrator, &now.measured, now.stands), ZERORATE_OK);
  }
  const float before_rad = integrator.heading_rad;
  const Moment now = moment(kStopSamples + 1000);
  ASSERT_EQ(heading_step(&integrator, &now.measured, now.stands), ZERORATE_OK);
  EXPECT_EQ(integrator.heading_rad, before_rad);
}

/// Sums: the filter's variance of the heading error, and the error itself.
TEST(ErrorStateFilter, TakesTheBiasAtEachStopAndKnowsItsError) {
  zerorate_node node;
  ASSERT_EQ(zerorate_init(&node, &front_gyro, nullptr), ZERORATE_OK);
  const double n = std::sqrt(double{front_gyro.white_variance_rad2_s2} * double{kPeriod_s});
  examples::ErrorStateFilter filter{{.angle_random_walk_rad_sqrt_s = static_cast<float>(n)}, 0, 0};
  zerorate_rate newest{};
  for (std::int64_t k = 0; k < kDrives * kCycle; ++k) {
    const Moment now = moment(k);
    if (!now.stands && newest.motion == ZERORATE_STILL) {
      filter.measure_bias(newest.bias_rad_s[2], newest.sigma_rad_s[2]);
    }
    newest = feed(node, now);
    if (!now.stands) filter.propagate(now.measured.rate_rad_s[2], kPeriod_s);
  }
  const double sigma_rad = std::sqrt(double{filter.covariance()(0, 0)});
  EXPECT_LT(std::abs(double{filter.heading_rad()} - kTrueHeading_rad), 4.0 * sigma_rad + 3e-4);
  EXPECT_NEAR(filter.bias_rad_s(), testing::kBias[2], 4.0F * std::sqrt(filter.covariance()(1, 1)));
  EXPECT_LT(sigma_rad, 0.02);
}

// Calculation by hand: both variances 1, the measurement's 1, so that half of the residual is
// taken.
TEST(ErrorStateFilterWithACompass, TakesItsShare) {
  examples::ErrorStateFilter filter{{}, 0.5F, 1.0F};
  filter.measure_heading(1.0F, 1.0F);
  EXPECT_FLOAT_EQ(filter.heading_rad(), 0.75F);
  EXPECT_FLOAT_EQ(filter.covariance()(0, 0), 0.5F);
}

// A bias of which nothing is known, seen by a compass after ten seconds of standing.
TEST(ErrorStateFilterWithACompass, LearnsTheBiasFromIt) {
  examples::ErrorStateFilter filter{{}, 0.0F, 0.0F};
  filter.measure_bias(0.0F, 0.01F);
  for (int k = 0; k < 1000; ++k) filter.propagate(0.005F, 0.01F);
  filter.measure_heading(0.0F, 1e-4F);
  EXPECT_NEAR(filter.bias_rad_s(), 0.005F, 1e-5F);
}

}  // namespace
}  // namespace zerorate::c_api

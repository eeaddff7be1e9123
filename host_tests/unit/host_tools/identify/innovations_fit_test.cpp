#include "host_tools/lib/identify/innovations_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::identify {
namespace {

using zerorate::testing::drop_drives;
using zerorate::testing::kRadPerDeg;
using zerorate::testing::rest_samples_of;
using zerorate::testing::RestNoise;
using zerorate::testing::simulate_rest;

constexpr double kPeriod = 0.1;
constexpr StartValues kStart{.angle_random_walk_rad_per_sqrt_s = 0.05 * kRadPerDeg,
                             .bias_instability_rad_s = 15.0 / 3600.0 * kRadPerDeg};
constexpr core::Duration kTick = core::Duration::milliseconds(500);

InnovationsFit fit_of(const simulate::Signal& signal, const InnovationsFitOptions& options) {
  const RestSamples samples = rest_samples_of(signal);
  return fit_by_innovations(
      InnovationsLikelihood{average_ticks(samples, kTick), 0, samples.sample_period, kTick},
      options);
}

/// Within four of its own standard errors: once in 16,000 seeds by chance.
void expect_near(const IntervalEstimate& estimate, double truth) {
  EXPECT_GT(estimate.standard_error, 0.0);
  EXPECT_NEAR(estimate.value, truth, 4.0 * estimate.standard_error);
  EXPECT_LT(estimate.lo, estimate.value);
  EXPECT_GT(estimate.hi, estimate.value);
}

TEST(InnovationsFitOfALongRecord, FindsStrengthsAndOrder) {
  const RestNoise noise{.order = 0.65};
  const InnovationsFit fit =
      fit_of(simulate_rest(noise, 100'000, kPeriod, 1), {.starts = {kStart}});
  expect_near(fit.angle_random_walk_rad_per_sqrt_s, 0.04 * kRadPerDeg);
  ASSERT_TRUE(fit.flicker.has_value());
  EXPECT_EQ(fit.flicker->order_source, OrderSource::estimated);
  expect_near(fit.flicker->order, 0.65);
  expect_near(fit.flicker->bias_instability_rad_s, 25.0 / 3600.0 * kRadPerDeg);
  EXPECT_LT(fit.p_value, 1e-6);
}

TEST(InnovationsFitOfStopsAndDrives, FindsTheSameStrengths) {
  simulate::Signal signal = simulate_rest({}, 200'000, kPeriod, 2);
  drop_drives(signal, 400);  // 40 s still, 80 s driving
  const InnovationsFit fit = fit_of(signal, {.starts = {kStart}, .order = 0.5});
  expect_near(fit.angle_random_walk_rad_per_sqrt_s, 0.04 * kRadPerDeg);
  ASSERT_TRUE(fit.flicker.has_value());
  EXPECT_EQ(fit.flicker->order_source, OrderSource::given);
  EXPECT_EQ(fit.flicker->order.value, 0.5);
  EXPECT_EQ(fit.flicker->order.standard_error, 0.0);
  expect_near(fit.flicker->bias_instability_rad_s, 25.0 / 3600.0 * kRadPerDeg);
}

TEST(InnovationsFitOfWhiteNoise, InventsNoFlicker) {
  const RestNoise white{.bias_instability_dph = 0.0};
  const InnovationsFit fit = fit_of(simulate_rest(white, 50'000, kPeriod, 4), {.starts = {kStart}});
  EXPECT_FALSE(fit.flicker.has_value());
  EXPECT_GT(fit.p_value, 0.01);
  expect_near(fit.angle_random_walk_rad_per_sqrt_s, 0.04 * kRadPerDeg);
  // The variance of n ticks has the relative error sqrt(2 / n), their root half of that.
  EXPECT_NEAR(fit.angle_random_walk_rad_per_sqrt_s.standard_error /
                  fit.angle_random_walk_rad_per_sqrt_s.value,
              std::sqrt(0.5 / 10'000), 1e-6);
  EXPECT_FALSE(fit.model(0.5).flicker.has_value());
}

TEST(InnovationsFitOfAShortRecord, KeepsThePriorOrderAndTellsTheOther) {
  const InnovationsFit fit = fit_of(simulate_rest({}, 15'000, kPeriod, 4), {.starts = {kStart}});
  ASSERT_TRUE(fit.flicker.has_value());
  EXPECT_EQ(fit.flicker->order_source, OrderSource::prior);
  EXPECT_EQ(fit.flicker->order.value, 0.5);
  ASSERT_TRUE(fit.flicker->rejected_order.has_value());
  EXPECT_GT(fit.flicker->rejected_order->hi - fit.flicker->rejected_order->lo,
            kWidestOrderInterval);
}

TEST(InnovationsFitOfARamp, SaysThatTheOrderIsAtItsLimit) {
  simulate::Signal signal = simulate_rest({.bias_instability_dph = 0.0}, 50'000, kPeriod, 5);
  simulate::RateRamp{1e-6}.apply(signal, random::RandomStream(1));
  const InnovationsFit fit = fit_of(signal, {.starts = {kStart}});
  ASSERT_TRUE(fit.flicker.has_value());
  EXPECT_EQ(fit.flicker->order_source, OrderSource::limit);
}

TEST(InnovationsFitFromAnotherStart, EndsAtTheSameMaximum) {
  const simulate::Signal signal = simulate_rest({}, 50'000, kPeriod, 6);
  const InnovationsFit near = fit_of(signal, {.starts = {kStart}});
  const InnovationsFit far =
      fit_of(signal, {.starts = {{kStart.angle_random_walk_rad_per_sqrt_s * 3.0,
                                  kStart.bias_instability_rad_s * 5.0}}});
  EXPECT_NEAR(far.minus_two_log_likelihood, near.minus_two_log_likelihood, 0.05);
  EXPECT_NEAR(far.angle_random_walk_rad_per_sqrt_s.value,
              near.angle_random_walk_rad_per_sqrt_s.value,
              0.1 * near.angle_random_walk_rad_per_sqrt_s.standard_error);
}

TEST(InnovationsFit, RefusesWhatItCannotJudge) {
  const simulate::Signal signal = simulate_rest({}, 5'000, kPeriod, 7);
  EXPECT_THROW((void)fit_of(signal, {.starts = {kStart}, .order = 0.99}), std::invalid_argument);
  EXPECT_THROW((void)fit_of(signal, {}), std::invalid_argument);
  EXPECT_THROW((void)fit_of(simulate_rest({}, 300, kPeriod, 8), {.starts = {kStart}}),
               recording::DataError);
  EXPECT_THROW((void)fit_of(simulate::Signal(5'000, kPeriod), {.starts = {kStart}}),
               recording::DataError);
}

}  // namespace
}  // namespace zerorate::identify

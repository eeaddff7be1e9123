#include "host_tools/lib/identify/innovations_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "firmware/model/node_model.hpp"
#include "host_tests/support/dense_noise.hpp"
#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/identify/innovations_likelihood.hpp"
#include "host_tools/lib/random/random_stream.hpp"
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

TEST(DataSheetOfAFit, IsTheFitWithTheOrderOfADataSheet) {
  const simulate::Signal signal = simulate_rest({.order = 0.65}, 100'000, kPeriod, 1);
  const InnovationsFit sheet = fit_of(signal, {.starts = {kStart}}).data_sheet();
  const InnovationsFit given = fit_of(signal, {.starts = {kStart}, .order = 0.5});
  ASSERT_TRUE(sheet.flicker && given.flicker);
  EXPECT_EQ(sheet.flicker->order.value, 0.5);
  const auto expect_same = [](const IntervalEstimate& one, const IntervalEstimate& other) {
    EXPECT_NEAR(one.value, other.value, 0.1 * other.standard_error);
  };
  expect_same(sheet.angle_random_walk_rad_per_sqrt_s, given.angle_random_walk_rad_per_sqrt_s);
  expect_same(sheet.flicker->bias_instability_rad_s, given.flicker->bias_instability_rad_s);
  EXPECT_EQ(given.data_sheet().flicker->bias_instability_rad_s.value,
            given.flicker->bias_instability_rad_s.value);
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

TEST(InnovationsFitOfAShortRecord, KeepsThePriorOrder) {
  const InnovationsFit fit = fit_of(simulate_rest({}, 15'000, kPeriod, 4), {.starts = {kStart}});
  ASSERT_TRUE(fit.flicker.has_value());
  EXPECT_EQ(fit.flicker->order_source, OrderSource::prior);
  EXPECT_EQ(fit.flicker->order.value, 0.5);
  ASSERT_TRUE(fit.flicker->rejected_order.has_value());
  EXPECT_GT(fit.flicker->rejected_order->hi - fit.flicker->rejected_order->lo,
            kWidestOrderInterval);
}

// The profile over d is the oracle: a standard error away on both sides -2 log L has risen by one.
// Third powers cancel in the mean of the sides.
TEST(InnovationsFitOfAnUncertainOrder, StatesTheProfilesError) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const simulate::Signal signal = simulate_rest({}, 40'000, kPeriod, seed);
    const InnovationsFit fit = fit_of(signal, {.starts = {kStart}});
    ASSERT_TRUE(fit.flicker.has_value()) << seed;
    const IntervalEstimate order = fit.flicker->rejected_order.value_or(fit.flicker->order);
    const auto minus_two_log = [&](double d) {
      return fit_of(signal, {.starts = {kStart}, .order = d}).minus_two_log_likelihood;
    };
    const double rise = 0.5 * (minus_two_log(order.value - order.standard_error) +
                               minus_two_log(order.value + order.standard_error)) -
                        minus_two_log(order.value);
    EXPECT_GT(rise, 0.9) << seed;
    EXPECT_LT(rise, 1.1) << seed;
  }
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

constexpr core::Duration kSamplePeriod = core::Duration::milliseconds(100);

model::SensorModel sample_model() {
  model::SensorModel model{.name = "sample"};
  model.white.angle_random_walk_rad_per_sqrt_s = 7e-4;
  model.flicker = model::Flicker{.bias_instability_rad_s = 2e-4, .order = 0.6};
  return model;
}

/// Ticks with holes and with few samples; rates of about the size that the model expects.
std::vector<TickMean> ticks_with_holes(float bias_rad_s = 0.0F) {
  const random::RandomStream stream(3);
  std::vector<TickMean> ticks;
  std::uint32_t tick = 2;
  for (std::int64_t k = 0; k < 60; ++k) {
    const auto samples = static_cast<std::uint32_t>(1 + k % 5);
    const auto rate = static_cast<float>(1e-3 * stream.normal(k));
    ticks.push_back({.tick = tick, .samples = samples, .rate_rad_s = {0.0F, bias_rad_s + rate}});
    tick += k % 20 == 19 ? 137U : 1U;
  }
  return ticks;
}

/// The density of all differences from the first tick, from their covariance matrix.
double dense_minus_two_log(const std::vector<TickMean>& ticks, const model::SensorModel& model) {
  const auto node =
      model::make_node_model<core::ModelShape{.decaying = 6}>(model, kSamplePeriod, kTick);
  const Eigen::MatrixXd bias =
      zerorate::testing::bias_covariance(node.modes, static_cast<int>(ticks.back().tick) + 1);
  const auto size = static_cast<Eigen::Index>(ticks.size());
  Eigen::MatrixXd covariance(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const TickMean& a = ticks[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < size; ++j) {
      covariance(i, j) = bias(a.tick, ticks[static_cast<std::size_t>(j)].tick);
    }
    covariance(i, i) += double{node.white_variance_rad2_s2} / a.samples;
  }
  Eigen::MatrixXd contrast(size - 1, size);
  contrast << -Eigen::VectorXd::Ones(size - 1), Eigen::MatrixXd::Identity(size - 1, size - 1);
  Eigen::VectorXd rates(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    rates(i) = double{ticks[static_cast<std::size_t>(i)].rate_rad_s[1]};
  }
  const Eigen::VectorXd differences = contrast * rates;
  const Eigen::LDLT<Eigen::MatrixXd> factors(contrast * covariance * contrast.transpose());
  return factors.vectorD().array().log().sum() + differences.dot(factors.solve(differences));
}

TEST(InnovationsLikelihood, EqualsTheDenseGaussianDensity) {
  const std::vector<TickMean> ticks = ticks_with_holes();
  const InnovationsLikelihood likelihood{ticks, 1, kSamplePeriod, kTick};
  for (const double order : {0.3, 0.5, 0.8}) {
    model::SensorModel model = sample_model();
    model.flicker->order = order;
    // Single precision: some 1e-6 a tick.
    EXPECT_NEAR(likelihood(model).minus_two_log(), dense_minus_two_log(ticks, model), 1e-3)
        << order;
  }
}

TEST(InnovationsLikelihood, OfAZeroStartEqualsTheDenseOneToo) {
  const std::vector<TickMean> ticks = ticks_with_holes();
  model::SensorModel model = sample_model();
  model.node.start = core::Start::zero;
  EXPECT_NEAR((InnovationsLikelihood{ticks, 1, kSamplePeriod, kTick}(model).minus_two_log()),
              dense_minus_two_log(ticks, model), 1e-3);
}

TEST(InnovationsLikelihood, LeavesOutTheFirstInnovation) {
  const std::vector<TickMean> ticks = ticks_with_holes();
  const InnovationsLikelihood likelihood{ticks, 1, kSamplePeriod, kTick};
  EXPECT_EQ(likelihood(sample_model()).innovations, ticks.size() - 1);
}

TEST(InnovationsLikelihood, DoesNotDependOnTheBias) {
  const double without =
      InnovationsLikelihood{ticks_with_holes(), 1, kSamplePeriod, kTick}(sample_model())
          .minus_two_log();
  // 10 deg/s; a tick's rate of 0.17 rad/s is rounded by up to 7.5e-9 rad/s, 1e-5 of its sigma.
  const double with =
      InnovationsLikelihood{ticks_with_holes(0.17F), 1, kSamplePeriod, kTick}(sample_model())
          .minus_two_log();
  EXPECT_NEAR(with, without, 1e-2);
}

TEST(InnovationsLikelihood, IsLargestNearTheModelThatMadeTheRecord) {
  // White noise of 5 samples a tick: the variance of a tick is N^2 / tick.
  const random::RandomStream stream(4);
  std::vector<TickMean> ticks;
  const double sigma = 7e-4 / std::sqrt(0.5);
  for (std::uint32_t k = 0; k < 2000; ++k) {
    ticks.push_back(
        {.tick = k, .samples = 5, .rate_rad_s = {static_cast<float>(sigma * stream.normal(k))}});
  }
  const InnovationsLikelihood likelihood{ticks, 0, kSamplePeriod, kTick};
  model::SensorModel model{.name = "white"};
  const auto at = [&](double factor) {
    model.white.angle_random_walk_rad_per_sqrt_s = 7e-4 * factor;
    return likelihood(model).minus_two_log();
  };
  // The curvature is 4 n in log N: 2000 ticks at 1.1 cost 2 * 2000 * log(1.1)^2 = 36.
  EXPECT_GT(at(1.1) - at(1.0), 20.0);
  EXPECT_GT(at(0.9) - at(1.0), 20.0);
}

TEST(InnovationsLikelihood, RefusesASingleTick) {
  const std::vector<TickMean> one(1);
  EXPECT_THROW((InnovationsLikelihood{one, 0, kSamplePeriod, kTick}), recording::DataError);
}

}  // namespace
}  // namespace zerorate::identify

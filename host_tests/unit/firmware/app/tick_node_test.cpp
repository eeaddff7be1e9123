#include "firmware/app/tick_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/app/tick_forecast.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

using testing::at_ms;

constexpr core::Duration kTick = core::Duration::milliseconds(500);
constexpr core::ModelShape kLearningShape{.decaying = 6, .hypotheses = model::kMostHypotheses};
constexpr NodeCapacity kKalmanAlone{.runs_moving_average = false, .runs_calibration_mean = false};
using Ticks = TickNode<kLearningShape, kKalmanAlone>;

/// Parameters of an LSM6DSO that learns its noise.
[[nodiscard]] Ticks::Params learning_params(core::Duration sample_period) {
  return {.model = model::make_node_model<kLearningShape>(model::find_model("lsm6dso"),
                                                          sample_period, kTick)};
}

/// Measurement of a tick of a stop that began with tick 0.
[[nodiscard]] Ticks::Tick tick_of(std::uint32_t number) {
  Ticks::Tick tick;
  tick.tick = number;
  tick.samples = 52;
  tick.begins_stop = number == 0;
  for (std::size_t i = 0; i < tick.rate_rad_s.size(); ++i) {
    const random::RandomStream noise{3, i};
    tick.rate_rad_s[i] = 0.01F + 2e-5F * static_cast<float>(noise.normal(number));
  }
  return tick;
}

/// A node that has learnt these ticks, and predicted each of them before.
void stand(Ticks& node, std::uint32_t ticks) {
  for (std::uint32_t k = 0; k < ticks; ++k) {
    node.begin_tick(k);
    node.finish();
    node.learn(tick_of(k));
    node.finish();
  }
}

/// Verifies SR-TIME-02.
TEST(TickNodeFedStepByStep, IsAsIfFedAtOnce) {
  const auto params = learning_params(core::Duration::milliseconds(10));
  Ticks at_once{params};
  Ticks stepwise{params};
  stand(at_once, 200);
  for (std::uint32_t k = 0; k < 200; ++k) {
    stepwise.begin_tick(k);
    while (stepwise.is_busy()) stepwise.step();
    stepwise.learn(tick_of(k));
    while (stepwise.is_busy()) stepwise.step();
  }
  EXPECT_TRUE(stepwise.state() == at_once.state());
}

/// The oracle is the bank itself, advanced and measured at once.
TEST(TickNodeOfOneAxis, HasTheInnovationsOfItsBank) {
  constexpr core::ModelShape kShape{.decaying = 6};
  const NodeParams<kShape> params{
      .model = model::make_node_model<kShape>(model::find_model("lsm6dso"),
                                              core::Duration::milliseconds(10), kTick),
      .learns_white_noise = false};
  TickNode<kShape, kFilterAlone> node{params};
  const core::KalmanCoefficients<kShape> coefficients{params.model.modes};
  core::KalmanBank<kShape, 1> bank{coefficients};
  std::uint32_t measured = 0;
  for (const std::uint32_t k : {0U, 1U, 2U, 3U, 500U, 501U, 502U, 90'000U, 90'001U}) {
    const float rate = tick_of(k).rate_rad_s[0];
    const core::Innovation& seen = node.learn_at_once(
        {{.tick = k, .samples = 52, .end = {}, .rate_rad_s = {rate}}, k == 0, {}, {}})[0];
    bank.advance(params.model.modes.over(k + 1 - measured));
    const core::Innovation expected =
        bank.observe({rate}, params.model.measurement_variance(52.0F))[0];
    EXPECT_EQ(seen, expected) << k;
    measured = k + 1;
  }
}

/// A drive of a minute, a measurement, and a forecast after each step of learning it.
TEST(TickNodeInTheMiddleOfItsWork, ForecastsFromEachFilter) {
  const auto params = learning_params(core::Duration::milliseconds(10));
  Ticks node{params};
  stand(node, 100);
  node.begin_tick(220);
  node.finish();
  const auto sigma = [&] {
    return TickForecast<Ticks>{node}.predict(Predictor::kalman, 0).sigma_rad_s();
  };
  const auto heading_sigma = [&] {
    return TickForecast<Ticks>{node}.predict_heading(Predictor::kalman, 0, 221, 341).sigma_rad();
  };
  const float before = sigma();
  const float heading_before = heading_sigma();
  Ticks finished{params};
  finished.restore(node.state());
  finished.learn(tick_of(220));
  finished.finish();
  const float after = TickForecast<Ticks>{finished}.predict(Predictor::kalman, 0).sigma_rad_s();
  node.learn(tick_of(220));
  while (node.is_busy()) {
    node.step();
    EXPECT_LT(sigma(), 1.1F * std::max(before, after));
    EXPECT_GT(sigma(), 0.9F * std::min(before, after));
    EXPECT_LT(heading_sigma(), 1.5F * heading_before);
  }
  EXPECT_FLOAT_EQ(sigma(), after);
}

/// Samples at 26 Hz: 13 share the work of a tick.
/// Verifies SR-TIME-02.
TEST(GyroNodeThatLearnsAtALowRate, CompletesEachTickBeforeTheNext) {
  using LearningNode = GyroNode<kLearningShape, kKalmanAlone>;
  constexpr core::Duration kPeriod = core::Duration::nanoseconds(38'461'538);
  const LearningNode::Params params{.model = learning_params(kPeriod).model};
  LearningNode node{params};
  core::Instant at;
  for (int k = 0; k < 2000; ++k, at = at + kPeriod) {
    const std::uint32_t tick = node.tick();
    const bool was_busy = node.ticks().is_busy() || node.is_learning();
    (void)node.step(testing::noisy_sample(at, 0.01F));
    if (k > 100 && node.tick() != tick) {
      EXPECT_FALSE(was_busy) << k;
    }
  }
  EXPECT_GT(node.measured_ticks(), 140U);
}

/// One sample in ten arrives: the work piles up, and the line of held ticks never overflows.
/// Verifies SR-TIME-04.
TEST(GyroNodeThatLosesSamples, LearnsAllTheSame) {
  using LearningNode = GyroNode<kLearningShape, kKalmanAlone>;
  const LearningNode::Params params{.model =
                                        learning_params(core::Duration::milliseconds(10)).model};
  LearningNode node{params};
  for (std::int64_t ms = 0; ms < 600'000; ms += 100) {
    (void)node.step(testing::noisy_sample(at_ms(ms), 0.01F));
  }
  EXPECT_GT(node.measured_ticks(), 1180U);
}

}  // namespace
}  // namespace zerorate::app

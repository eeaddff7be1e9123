#include "firmware/app/gyro_node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

float node_sigma(const testing::Node& node) {
  return std::sqrt(node.white_variance_rad2_s2(0));
}

using core::Duration;
using testing::at_ms;
using testing::bias_of;
using testing::drive;
using testing::expect_same;
using testing::kBias;
using testing::kWhiteSigmaRadS;
using testing::learnt;
using testing::Node;
using testing::node_params;
using testing::noisy_sample;
using testing::sample_at;
using testing::stand;

// Every offset of the pulse against the ticks and the samples, the exact coincidences among them.
TEST(GyroNodeAtTheFirstPulse, KeepsTheMeanOfTheWholeStop) {
  const auto params = node_params();
  for (std::int64_t offset_ms = 0; offset_ms <= 200; ++offset_ms) {
    Node node{params};
    stand(node, 0, 10'000 + offset_ms / 10 * 10);
    const std::uint32_t learnt = node.state().ticks.predictors.axes[0].calibration_mean.count;
    node.pulse(at_ms(10'000 + offset_ms));
    (void)node.step(noisy_sample(at_ms(10'000 + offset_ms + 10), kBias));
    EXPECT_GE(node.state().ticks.predictors.axes[0].calibration_mean.count, learnt)
        << offset_ms << " ms";
    EXPECT_GE(node.state().ticks.predictors.axes[0].moving_average.sums.count(), learnt)
        << offset_ms << " ms";
  }
}

/// Verifies SR-PRED-01.
TEST(GyroNodeAfterAStop, HasTheSensorsBiasAndTakesItOffTheRate) {
  const auto params = node_params();
  Node node{params};
  EXPECT_FALSE(stand(node, 0, 1'500).back().health.calibrated);
  const RateMessage still = stand(node, 1'500, 61'500).back();
  EXPECT_TRUE(still.health.calibrated);
  EXPECT_EQ(still.motion, core::Motion::still);
  const RateMessage moving = drive(node, 61'500, 61'510).back();
  EXPECT_EQ(moving.motion, core::Motion::moving);
  EXPECT_EQ(moving.health, Health{.calibrated = true});
  // 600 ticks of 10 samples: the mean's white error is sigma / sqrt(6000); the flicker of the model
  // is smaller. Five standard deviations of both together.
  const float white = kWhiteSigmaRadS / std::sqrt(6000.0F);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisRate& rate = moving.axes[axis];
    const float bound = 5.0F * std::hypot(white, rate.sigma.in(core::rad_per_s));
    EXPECT_NEAR(rate.bias.in(core::rad_per_s), kBias * static_cast<float>(axis + 1), bound);
    EXPECT_EQ(rate.corrected, rate.measured - rate.bias);
    EXPECT_LT(rate.sigma.in(core::rad_per_s), kWhiteSigmaRadS);
  }
}

/// Verifies SR-PRED-06.
TEST(GyroNodeThatKnowsItsLatitude, RemovesTheEarthsRotation) {
  const auto params = node_params();
  auto params_at_60 = params;
  params_at_60.earth = core::earth_rate(60.0F, {});
  Node unaware{params};
  Node aware{params_at_60};
  stand(unaware, 0, 61'500);
  stand(aware, 0, 61'500);
  const RateMessage without = drive(unaware, 61'500, 61'510).back();
  const RateMessage with = drive(aware, 61'500, 61'510).back();
  constexpr float kRounding = 1e-6F;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float earth = params_at_60.earth.vertical_rad_s[axis];
    EXPECT_NEAR(with.axes[axis].bias.in(core::rad_per_s),
                without.axes[axis].bias.in(core::rad_per_s)-earth, kRounding);
    EXPECT_NEAR(with.axes[axis].corrected.in(core::rad_per_s),
                without.axes[axis].corrected.in(core::rad_per_s), kRounding);
    const float added = params_at_60.earth.heading_variance_rad2_s2[axis];
    const float sigma = without.axes[axis].sigma.in(core::rad_per_s);
    EXPECT_NEAR(with.axes[axis].sigma.in(core::rad_per_s), std::sqrt(sigma * sigma + added),
                1e-3F * sigma);
    const auto heading = [&](const Node& node) {
      return node.predict_heading(Predictor::kalman, axis, at_ms(61'510), at_ms(361'510));
    };
    EXPECT_NEAR(heading(aware).variance_rad2,
                heading(unaware).variance_rad2 + added * 300.0F * 300.0F,
                1e-2F * heading(aware).variance_rad2);
  }
}

/// Verifies SR-LEARN-01.
TEST(GyroNodeOnTheMove, LearnsNothing) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  drive(node, 20'000, 20'010);
  node.finish_learning();  // the ticks that were certain at the first pulse
  const Node::State before = node.state();
  drive(node, 20'010, 80'000, 1.0F);
  const Node::State after = node.state();
  EXPECT_EQ(after.ticks.measured_ticks, before.ticks.measured_ticks);
  for (std::size_t i = 0; i < 3; ++i) {
    expect_same(after.ticks.predictors.kalman, before.ticks.predictors.kalman);
    expect_same(after.ticks.predictors.axes[i].moving_average,
                before.ticks.predictors.axes[i].moving_average);
    expect_same(after.ticks.predictors.axes[i].calibration_mean,
                before.ticks.predictors.axes[i].calibration_mean);
  }
}

/// Verifies SR-LEARN-02.
TEST(GyroNodeInTheSettleTime, LearnsNothingOfTheRocking) {
  const auto params = node_params();
  Node rocking{params};
  Node quiet{params};
  for (Node* node : {&rocking, &quiet}) {
    stand(*node, 0, 20'000);
    drive(*node, 20'000, 25'000);
  }
  // The newest pulse was at 24.99 s: up to 25.99 s nothing counts.
  stand(rocking, 25'000, 25'990, 0.5F);
  stand(quiet, 25'000, 25'990);
  stand(rocking, 25'990, 40'000);
  stand(quiet, 25'990, 40'000);
  expect_same(learnt(rocking.state()), learnt(quiet.state()));
}

/// Verifies SR-LEARN-03.
TEST(GyroNodeBeforeTheFirstPulse, DiscardsATurnInProgress) {
  const auto params = node_params();
  Node turning{params};
  Node straight{params};
  for (Node* node : {&turning, &straight}) stand(*node, 0, 20'000);
  // A slow turn in the last 490 ms; the pulse tells only then. Hold-back is 500 ms.
  stand(turning, 20'000, 20'490, kBias + 0.02F);
  stand(straight, 20'000, 20'490);
  drive(turning, 20'490, 25'000);
  drive(straight, 20'490, 25'000);
  stand(turning, 25'000, 30'000);
  stand(straight, 25'000, 30'000);
  expect_same(learnt(turning.state()), learnt(straight.state()));
}

TEST(GyroNodeBeforeTheFirstPulse, NeedsTheHoldBackForIt) {
  auto params = node_params();
  params.standstill.hold_back = Duration{};
  Node turning{params};
  Node straight{params};
  for (Node* node : {&turning, &straight}) stand(*node, 0, 20'000);
  stand(turning, 20'000, 20'490, kBias + 0.02F);
  stand(straight, 20'000, 20'490);
  for (Node* node : {&turning, &straight}) {
    drive(*node, 20'490, 20'500);
    node->finish_learning();
  }
  for (const Predictor which :
       {Predictor::kalman, Predictor::moving_average, Predictor::calibration_mean}) {
    EXPECT_GT(bias_of(turning, which), bias_of(straight, which));
  }
}

/// Verifies SR-LEARN-04, SR-HEALTH-06.
TEST(GyroNodeWithLostPulses, ForgetsAllThatIsHeldAndSaysSoOnce) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  const std::uint32_t learnt = node.measured_ticks();
  node.report_odometer_fault(at_ms(21'000));
  const RateMessage first = node.step(noisy_sample(at_ms(21'000), kBias));
  EXPECT_EQ(first.motion, core::Motion::moving);
  EXPECT_TRUE(first.health.odometer_fault);
  EXPECT_FALSE(node.step(noisy_sample(at_ms(21'010), kBias)).health.odometer_fault);
  EXPECT_EQ(node.measured_ticks(), learnt);
  EXPECT_EQ(node.state().learning.held.size(), 0U);
}

TEST(GyroNodeAtPowerUp, LearnsNothingOfTenWildSamples) {
  const auto params = node_params();
  Node wild{params};
  Node tame{params};
  for (std::int64_t i = 0; i < 10; ++i) {
    (void)wild.step(sample_at(at_ms(10 * i), i % 2 == 0 ? 30.0F : -30.0F));
    (void)tame.step(sample_at(at_ms(10 * i), 0.0F));
  }
  stand(wild, 100, 20'000);
  stand(tame, 100, 20'000);
  expect_same(learnt(wild.state()), learnt(tame.state()));
}

/// Verifies SR-INT-05, SR-HEALTH-22.
TEST(GyroNodeAfterAGapOfAnHour, KeepsItsBiasLessCertainly) {
  const auto params = node_params();
  Node node{params};
  const RateMessage before = stand(node, 0, 60'000).back();
  constexpr std::int64_t kLater = 3'660'000;
  const RateMessage first = node.step(noisy_sample(at_ms(kLater), kBias));
  EXPECT_TRUE(first.has_rate());
  EXPECT_FALSE(first.health.calibrated) << "the interval of before is too narrow";
  const RateMessage after = stand(node, kLater + 10, kLater + 100).back();
  EXPECT_TRUE(after.health.calibrated);
  EXPECT_NEAR(after.axes[0].bias.in(core::rad_per_s), kBias,
              5.0F * after.axes[0].sigma.in(core::rad_per_s));
  EXPECT_GT(after.axes[0].sigma, before.axes[0].sigma);
  const std::uint32_t learnt = node.measured_ticks();
  EXPECT_LT(stand(node, kLater + 100, kLater + 60'000).back().axes[0].sigma, after.axes[0].sigma);
  EXPECT_GT(node.measured_ticks(), learnt);
}

TEST(GyroNodeWithABiasOfTwelveDegreesPerSecond, IsExact) {
  const auto params = node_params();
  const float twelve = core::deg_per_s(12.0F).in(core::rad_per_s);
  Node large{params};
  Node small{params};
  stand(large, 0, 60'000, twelve);
  stand(small, 0, 60'000, 0.0F);
  for (const Predictor which :
       {Predictor::kalman, Predictor::moving_average, Predictor::calibration_mean}) {
    // The rates of z, three times 12 deg/s, are rounded to half of 2^-24 of 0.63 rad/s: 3.7e-8. A
    // mean of rounded rates is nearer than the worst of them; the answer is rounded once more.
    const float difference = bias_of(large, which, 2) - bias_of(small, which, 2);
    EXPECT_NEAR(difference, 3.0F * twelve, 7.5e-8F);
  }
}

/// Verifies SR-TIME-01.
TEST(GyroNodeWhoseSensorIsTwoPercentOff, CountsTimeByTheStamps) {
  const auto params = node_params();
  for (const std::int64_t period_us : {9'800, 10'200}) {
    Node node{params};
    std::int64_t us = 0;
    for (; us < 60'000'000; us += period_us) {
      (void)node.step(noisy_sample(core::Instant::from_ns(us * 1000), kBias));
    }
    // The first tick begins half a nominal period, 5 ms, before the first sample.
    EXPECT_EQ(std::int64_t{node.tick()}, (us - period_us + 5'000) / 100'000);
    EXPECT_NEAR(bias_of(node, Predictor::kalman), kBias,
                5.0F * kWhiteSigmaRadS / std::sqrt(5800.F));
  }
}

TEST(GyroNodeWithDroppedSamples, WeighsTicksByWhatTheyHold) {
  auto params = node_params();
  params.learns_white_noise = false;
  Node full{params};
  Node thin{params};
  stand(full, 0, 60'000);
  for (std::int64_t ms = 0; ms < 60'000; ms += 10) {
    if (ms % 100 < 50) (void)thin.step(noisy_sample(at_ms(ms), kBias));
  }
  EXPECT_EQ(thin.tick(), full.tick());
  full.finish_learning();
  thin.finish_learning();
  const auto thin_mean = thin.state().ticks.predictors.axes[0].calibration_mean;
  const auto full_mean = full.state().ticks.predictors.axes[0].calibration_mean;
  EXPECT_EQ(thin_mean.count, full_mean.count);
  EXPECT_FLOAT_EQ(thin_mean.white_variance_sum, 2.0F * full_mean.white_variance_sum);
  EXPECT_NEAR(bias_of(thin, Predictor::kalman), kBias, 5.0F * kWhiteSigmaRadS / std::sqrt(2900.F));
}

/// Verifies SR-HEALTH-13.
TEST(GyroNodeWithAGate, SaysThatItDoubtsAMeasurementUntilOneAgrees) {
  auto params = node_params();
  params.model.gate = {.threshold_sigma = 3.6F, .longest_knock_ticks = 50};
  Node node{params};
  EXPECT_FALSE(stand(node, 0, 10'000).back().health.measurement_rejected);
  // A knock of a tick, held back for a second and within the calm of half a second.
  stand(node, 10'000, 10'100, kBias + 0.0016F);
  // It is learnt from in the ten samples after that.
  stand(node, 10'100, 11'190);
  EXPECT_TRUE(stand(node, 11'190, 11'200).back().health.measurement_rejected);
  EXPECT_FALSE(stand(node, 11'200, 13'000).back().health.measurement_rejected);
}

/// Verifies SR-LEARN-09, SR-HEALTH-03.
TEST(GyroNodeWithASaturatedSample, PublishesItWithAFlag) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  auto saturated = sample_at(at_ms(20'000), 4.0F);
  saturated.saturated_axes = 0b010;
  const RateMessage message = node.step(saturated);
  EXPECT_TRUE(message.health.saturated);
  EXPECT_TRUE(message.has_rate());
  EXPECT_EQ(message.axes[1].measured, saturated.rate[1]);
  stand(node, 20'010, 22'000);

  Node never{params};  // the sample had been lost
  stand(never, 0, 20'000);
  stand(never, 20'010, 22'000);
  for (std::size_t i = 0; i < 3; ++i) {
    expect_same(node.state().ticks.predictors.kalman, never.state().ticks.predictors.kalman);
    expect_same(node.state().ticks.predictors.axes[i].calibration_mean,
                never.state().ticks.predictors.axes[i].calibration_mean);
  }
}

/// Verifies SR-PRED-11.
TEST(GyroNodeBuiltToPublishAPredictor, CorrectsByThatOne) {
  for (const Predictor which :
       {Predictor::kalman, Predictor::moving_average, Predictor::calibration_mean}) {
    auto params = node_params();
    params.published = which;
    Node node{params};
    stand(node, 0, 20'000);
    drive(node, 20'000, 20'010);
    node.finish_learning();
    const RateMessage message = drive(node, 20'010, 20'200).back();
    EXPECT_EQ(message.axes[0].bias, node.bias(which, 0));
    EXPECT_EQ(message.axes[0].sigma.in(core::rad_per_s), node.predict(which, 0).sigma_rad_s());
  }
}

/// Verifies SR-HEALTH-04.
TEST(GyroNodeWhoseSensorIsLouderThanItsModel, FlagsTheModel) {
  auto params = node_params();
  Node honest{params};
  EXPECT_FALSE(stand(honest, 0, 60'000).back().health.model_inconsistent);
  params.model.white_variance_rad2_s2 *= 0.25F;
  Node deceived{params};
  EXPECT_TRUE(stand(deceived, 0, 60'000).back().health.model_inconsistent);
}

// 64 spreads know a standard deviation within some 5 %, and the biases of the two are 1 % apart.
/// Verifies SR-LEARN-16.
TEST(GyroNodeWhoseSensorIsLouderThanItsModel, LearnsHowLoudItIs) {
  auto params = node_params();
  Node honest{params};
  stand(honest, 0, 60'000);
  params.model.white_variance_rad2_s2 *= 0.01F;
  Node deceived{params};
  stand(deceived, 0, 60'000);
  const auto sigma = [](const Node& node) {
    return node.predict(Predictor::kalman, 0).sigma_rad_s();
  };
  EXPECT_NEAR(sigma(deceived) / sigma(honest), 1.0F, 0.25F);
  EXPECT_NEAR(node_sigma(deceived), kWhiteSigmaRadS, 0.25F * kWhiteSigmaRadS);
  params.learns_white_noise = false;
  Node believing{params};
  stand(believing, 0, 60'000);
  EXPECT_FLOAT_EQ(node_sigma(believing), 0.1F * kWhiteSigmaRadS);
}

/// Verifies SR-HEALTH-20.
TEST(GyroNodeInAStopWithMotion, SaysHowMuchOfItWasCalm) {
  const auto params = node_params();
  Node node{params};
  EXPECT_EQ(stand(node, 0, 2'000).back().calm_percent, RateMessage::kNoCalm);
  EXPECT_EQ(stand(node, 2'000, 20'000).back().calm_percent, 100);
  for (int stop = 1; stop <= 4; ++stop) {
    const std::int64_t begin = 100'000 * stop;
    drive(node, begin, begin + 10'000);
    // It rolls for three seconds more, and turns by less than the odometer check tells.
    for (std::int64_t ms = 10'000; ms < 13'000; ms += 500) {
      stand(node, begin + ms, begin + ms + 500, kBias + (ms % 1000 == 0 ? 0.002F : 0.0F));
    }
    const RateMessage message = stand(node, begin + 13'000, begin + 30'000).back();
    EXPECT_LT(message.calm_percent, 95) << stop;
    EXPECT_GT(message.calm_percent, 70) << stop;
    EXPECT_EQ(message.health.odometer_dead_band, stop == 4) << stop;
    EXPECT_FALSE(message.health.odometer_disagreement) << stop;
  }
}

}  // namespace
}  // namespace zerorate::app

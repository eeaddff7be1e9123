#include "firmware/app/gyro_node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

using testing::at_ms;
using testing::drive;
using testing::kBias;
using testing::kNodeShape;
using testing::kWhiteSigmaRadS;
using testing::Node;
using testing::node_params;
using testing::noisy_sample;
using testing::sample_at;

TEST(GyroNodeWithoutTemperature, IsTheSameButSaysNone) {
  const auto params = node_params();
  Node with{params};
  Node without{params};
  for (std::int64_t ms = 0; ms < 20'000; ms += 10) {
    auto sample = noisy_sample(at_ms(ms), kBias);
    const RateMessage cold = without.step(sample);
    sample.has_temperature = true;
    sample.temperature = core::Temperature::from_degc(60.0F);
    RateMessage warm = with.step(sample);
    ASSERT_EQ(warm.temperature, sample.temperature);
    warm.temperature.reset();
    ASSERT_EQ(warm, cold);
  }
}

/// Four minutes of a node, and of one that is restored from its state at some times of them.
/// @param step one sample at a time in ms
template <class Node, class Step>
void expect_to_go_on_bit_for_bit(const typename Node::Params& params, Step step) {
  for (const std::int64_t cut : {30'050, 60'000, 119'990, 150'000}) {
    Node whole{params};
    std::int64_t ms = 0;
    for (; ms < cut; ms += 10) (void)step(whole, ms);
    Node second{params};
    second.restore(whole.state());
    for (; ms < 240'000; ms += 10) ASSERT_EQ(step(whole, ms), step(second, ms));
  }
}

/// A node that follows the temperature, from the one of node_params().
using WarmNode = GyroNode<core::ModelShape{.decaying = 4, .inputs = 2}>;
WarmNode::Params warm_params() {
  const auto plain = node_params();
  WarmNode::Params params{.model = {.modes = plain.model.modes,
                                    .white_variance_rad2_s2 = plain.model.white_variance_rad2_s2,
                                    .sample_period = plain.model.sample_period}};
  params.model.inputs =
      core::TemperatureDrift{.reference_degc = 30.0F, .slope_sigma_rad_s_per_k = 1e-2F}.terms();
  return params;
}

/// In minutes of standstill and of driving in turn; the temperature rises by a kelvin a minute, the
/// bias of x, y and z by 1, 2 and 3 times 1e-3 rad/s/K.
core::GyroSample warming_sample(std::int64_t ms) {
  constexpr float kSlope = 1e-3F;
  const float excess = static_cast<float>(ms) / 60'000.0F - 10.0F;
  auto sample = noisy_sample(at_ms(ms), kBias + kSlope * excess);
  sample.has_temperature = true;
  sample.temperature = core::Temperature::from_degc(30.0F + excess);
  return sample;
}
RateMessage warming_step(WarmNode& node, std::int64_t ms) {
  if (ms / 60'000 % 2 == 1) node.pulse(at_ms(ms));
  return node.step(warming_sample(ms));
}

/// Verifies SR-PRED-05.
TEST(GyroNodeThatFollowsTheTemperature, LearnsTheSlopeAcrossStops) {
  const auto params = warm_params();
  WarmNode node{params};
  std::int64_t ms = 0;
  for (; ms < 600'000; ms += 10) (void)warming_step(node, ms);
  // At the end of the sixth drive, a minute and a kelvin after it was measured, and in the last of
  // the ten samples that share the work of the tick.
  RateMessage message;
  for (int sample = 9; sample >= 0; --sample) {
    message = warming_step(node, ms - 10 + 60'000 - 10 * sample);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<float>(i + 1);
    const float truth = axis * (kBias + 1e-3F * (static_cast<float>(ms + 59'990) / 6e4F - 10.0F));
    const float error = message.axes[i].bias.in(core::rad_per_s)-truth;
    EXPECT_LT(std::abs(error), 1e-4F * axis);
    EXPECT_LT(std::abs(error), 4.0F * message.axes[i].sigma.in(core::rad_per_s));
  }
  EXPECT_FALSE(message.health.temperature_missing);
}

TEST(GyroNodeThatFollowsTheTemperature, RestoredGoesOnBitForBit) {
  expect_to_go_on_bit_for_bit<WarmNode>(warm_params(), warming_step);
}

/// Verifies SR-INT-07, SR-HEALTH-14.
TEST(GyroNodeWhoseThermometerFallsSilent, ReportsAndWidens) {
  const auto params = warm_params();
  WarmNode node{params};
  std::int64_t ms = 0;
  for (; ms < 60'000; ms += 10) (void)warming_step(node, ms);
  float sigma = 0.0F;
  for (; ms < 90'000; ms += 10) {
    auto sample = warming_sample(ms);
    sample.has_temperature = false;
    node.pulse(at_ms(ms));
    const RateMessage message = node.step(sample);
    EXPECT_EQ(message.health.temperature_missing, ms > 64'990) << ms;
    if (ms == 64'000) sigma = message.axes[0].sigma.in(core::rad_per_s);
    if (ms == 89'990) {
      EXPECT_GT(message.axes[0].sigma.in(core::rad_per_s), 2.0F * sigma);
    }
  }
}

/// A node whose bias follows the force along x and the vibration, from the one of node_params().
using LeaningNode =
    GyroNode<core::ModelShape{.decaying = 4, .inputs = 2, .has_accelerometer = true}>;
LeaningNode::Params leaning_params() {
  const auto plain = node_params();
  LeaningNode::Params params{.model = {.modes = plain.model.modes,
                                       .white_variance_rad2_s2 = plain.model.white_variance_rad2_s2,
                                       .sample_period = plain.model.sample_period}};
  params.model.inputs.terms = {
      {{core::Input::acceleration_x, 1e-2F, {}}, {core::Input::vibration, 1e-2F, {}}}};
  return params;
}
/// Minutes of standstill and of driving in turn, each leaning otherwise.
core::GyroSample leaning_sample(std::int64_t ms) {
  const float force_g = 0.1F * static_cast<float>(ms / 60'000 * 3 % 7) - 0.3F;
  auto sample = noisy_sample(at_ms(ms), kBias + 1e-3F * force_g);
  sample.has_acceleration = true;
  sample.acceleration = {core::standard_gravity(force_g), core::standard_gravity(0.0F),
                         core::standard_gravity(1.0F)};
  return sample;
}
RateMessage leaning_step(LeaningNode& node, std::int64_t ms) {
  if (ms / 60'000 % 2 == 1) node.pulse(at_ms(ms));
  return node.step(leaning_sample(ms));
}

TEST(GyroNodeThatFollowsTheForce, RestoredGoesOnBitForBit) {
  expect_to_go_on_bit_for_bit<LeaningNode>(leaning_params(), leaning_step);
}

/// Verifies SR-HEALTH-14.
TEST(GyroNodeWhoseAccelerometerFallsSilent, ReportsAfterASecond) {
  const auto params = leaning_params();
  LeaningNode node{params};
  std::int64_t ms = 0;
  for (; ms < 60'000; ms += 10) (void)leaning_step(node, ms);
  for (; ms < 70'000; ms += 10) {
    auto sample = leaning_sample(ms);
    sample.has_acceleration = false;
    node.pulse(at_ms(ms));
    EXPECT_EQ(node.step(sample).health.acceleration_missing, ms > 60'990) << ms;
  }
}

TEST(GyroNodeWithoutAnAccelerometer, RefusesAModelThatNeedsOne) {
  auto params = warm_params();
  params.model.inputs.terms[0] = {core::Input::acceleration_x, 1e-2F, {}};
  EXPECT_EQ(WarmNode::check(params).error(), ParamsError::no_accelerometer);
}

/// A node that looks at single samples: one in a thousand is wild.
using ScreeningNode = GyroNode<kNodeShape, NodeCapacity{.screens_samples = true}>;
ScreeningNode::Params screening_params() {
  auto params = node_params();
  params.model.samples.outliers = {.probability = 1e-3F,
                                   .variance_rad2_s2 = 1e4F * kWhiteSigmaRadS * kWhiteSigmaRadS};
  return params;
}

/// From 10 s on every 50th sample is off by 200 standard deviations on y.
bool is_wild(std::int64_t ms) {
  return ms > 10'000 && ms % 500 == 250;
}
core::GyroSample sometimes_wild_sample(std::int64_t ms) {
  auto sample = noisy_sample(at_ms(ms), kBias);
  if (is_wild(ms)) sample.rate[1] = sample.rate[1] + core::rad_per_s(200.0F * kWhiteSigmaRadS);
  return sample;
}

/// Verifies SR-HEALTH-13.
TEST(GyroNodeThatScreensSamples, LearnsNothingFromWildOnes) {
  const auto params = screening_params();
  ScreeningNode node{params};
  RateMessage message;
  for (std::int64_t ms = 0; ms < 60'000; ms += 10) {
    message = node.step(sometimes_wild_sample(ms));
    EXPECT_EQ(message.health.measurement_rejected, is_wild(ms)) << ms;
  }
  // 4 sigma off on average, had they been learnt from.
  EXPECT_NEAR(message.axes[1].bias.in(core::rad_per_s), 2.0F * kBias,
              4.0F * message.axes[1].sigma.in(core::rad_per_s));
}

TEST(GyroNodeThatScreensSamples, RestoredGoesOnBitForBit) {
  auto params = screening_params();
  params.model.samples.level = {.variance = 0.1F, .time_constants_per_tick = 1e-2F};
  params.model.samples.motion = {
      .begin_probability = 1e-3F, .end_probability = 0.1F, .variance_rad2_s2 = 1e-4F};
  for (const std::int64_t cut : {30'050, 30'260, 45'000}) {
    ScreeningNode whole{params};
    std::int64_t ms = 0;
    for (; ms < cut; ms += 10) (void)whole.step(sometimes_wild_sample(ms));
    ScreeningNode second{params};
    second.restore(whole.state());
    for (; ms < 60'000; ms += 10) {
      ASSERT_EQ(whole.step(sometimes_wild_sample(ms)), second.step(sometimes_wild_sample(ms)));
    }
  }
}

TEST(GyroNodeThatScreensSamples, FollowsTheStrengthOfTheNoise) {
  auto params = screening_params();
  params.model.samples = {};
  params.model.samples.level = {.variance = 1.0F, .time_constants_per_tick = 1e-3F};
  for (auto& mode : params.model.modes.decaying) {  // almost no flicker noise
    mode.noise_variance *= 1e-6F;
    mode.initial_variance *= 1e-6F;
  }
  ScreeningNode quiet{params};
  ScreeningNode loud{params};
  for (std::int64_t ms = 0; ms < 60'000; ms += 10) {
    const auto sample = noisy_sample(at_ms(ms), 0.0F);
    (void)quiet.step(sample);
    auto twice = sample;
    for (auto& rate : twice.rate) rate = rate + rate;
    (void)loud.step(twice);
  }
  // The bias has been the same throughout: its sigma is that of the mean, in proportion to the
  // noise.
  const float ratio = loud.predict(Predictor::kalman, 0).sigma_rad_s() /
                      quiet.predict(Predictor::kalman, 0).sigma_rad_s();
  EXPECT_NEAR(ratio, 2.0F, 0.1F);
}

TEST(GyroNodeOfASensorWithOneAxis, FollowsTheNoiseOfThatAxis) {
  auto params = screening_params();
  params.model.samples = {};
  params.model.samples.level = {.variance = 1.0F, .time_constants_per_tick = 1e-5F};
  ScreeningNode three{params};
  ScreeningNode one{params};
  for (std::int64_t ms = 0; ms < 60'000; ms += 10) {
    auto sample = noisy_sample(at_ms(ms), 0.0F);
    (void)three.step(sample);
    sample.rate[1] = sample.rate[2] = {};  // not there
    (void)one.step(sample);
  }
  // Both are near 1: with 10 samples a tick the mean of 3,000 ticks' worth is known to a few
  // percent.
  EXPECT_NEAR(one.state().ticks.white.track.level, 1.0F, 0.2F);
  EXPECT_NEAR(three.state().ticks.white.track.level, 1.0F, 0.2F);
}

/// Verifies SR-HEALTH-03.
TEST(GyroNodeThatKnowsItsRange, SaysWhenASampleIsAtItsEnd) {
  auto params = node_params();
  params.model.samples.range = {.lower_rad_s = -1.0F, .upper_rad_s = 1.0F};
  ScreeningNode node{params};
  EXPECT_FALSE(node.step(sample_at(at_ms(0), 0.3F)).health.saturated);  // z: 0.9
  EXPECT_TRUE(node.step(sample_at(at_ms(10), 0.4F)).health.saturated);
}

TEST(GyroNodeWithoutRoomForSamples, RefusesAModelOfThem) {
  const auto params = screening_params();
  EXPECT_EQ(Node::check(params).error(), ParamsError::no_room_for_samples);
  EXPECT_TRUE(ScreeningNode::check(params).has_value());
}

TEST(GyroNodeThatScreensNothing, GivesTheBitsOfOneWithoutRoomForIt) {
  const auto params = node_params();
  Node plain{params};
  ScreeningNode roomy{params};
  for (std::int64_t ms = 0; ms < 20'000; ms += 10) {
    const auto sample = sometimes_wild_sample(ms);
    ASSERT_EQ(plain.step(sample), roomy.step(sample));
  }
}

}  // namespace
}  // namespace zerorate::app

#include "firmware/app/gyro_node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

using core::Duration;
using testing::at_ms;
using testing::expect_same;
using testing::kSamplePeriod;
using testing::kWhiteSigmaRadS;
using testing::Node;
using testing::node_params;
using testing::noisy_sample;
using testing::sample_at;

constexpr float kBias = 0.01F;

float bias_of(const Node& node, Predictor which, std::size_t axis = 0) {
  return node.bias(which, axis).in(core::rad_per_s);
}

/// Noisy samples every 10 ms in [from, to); returns the messages.
std::vector<RateMessage> stand(Node& node, std::int64_t from_ms, std::int64_t to_ms,
                               float bias = kBias) {
  std::vector<RateMessage> messages;
  for (std::int64_t ms = from_ms; ms < to_ms; ms += 10) {
    messages.push_back(node.step(noisy_sample(at_ms(ms), bias)));
  }
  return messages;
}

/// Drives with a turn of `turn` rad/s on top and a pulse with each sample.
std::vector<RateMessage> drive(Node& node, std::int64_t from_ms, std::int64_t to_ms,
                               float turn = 0.3F) {
  std::vector<RateMessage> messages;
  for (std::int64_t ms = from_ms; ms < to_ms; ms += 10) {
    node.pulse(at_ms(ms));
    messages.push_back(node.step(noisy_sample(at_ms(ms), kBias + turn)));
  }
  return messages;
}

// Every offset of the pulse against the ticks and the samples, the exact coincidences among them.
TEST(GyroNodeAtTheFirstPulse, KeepsTheMeanOfTheWholeStop) {
  const auto params = node_params();
  for (std::int64_t offset_ms = 0; offset_ms <= 200; ++offset_ms) {
    Node node{params};
    stand(node, 0, 10'000 + offset_ms / 10 * 10);
    const std::uint32_t learnt = node.state().axes[0].calibration_mean.count;
    node.pulse(at_ms(10'000 + offset_ms));
    (void)node.step(noisy_sample(at_ms(10'000 + offset_ms + 10), kBias));
    EXPECT_GE(node.state().axes[0].calibration_mean.count, learnt) << offset_ms << " ms";
    EXPECT_GE(node.state().axes[0].moving_average.sums.count(), learnt) << offset_ms << " ms";
  }
}

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

TEST(GyroNodeOnTheMove, LearnsNothing) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 20'000);
  drive(node, 20'000, 20'010);
  const Node::State before = node.state();
  drive(node, 20'010, 80'000, 1.0F);
  const Node::State after = node.state();
  EXPECT_EQ(after.measured_ticks, before.measured_ticks);
  for (std::size_t i = 0; i < 3; ++i) {
    expect_same(after.axes[i].kalman, before.axes[i].kalman);
    expect_same(after.axes[i].moving_average, before.axes[i].moving_average);
    expect_same(after.axes[i].calibration_mean, before.axes[i].calibration_mean);
  }
}

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
  expect_same(rocking.state(), quiet.state());
}

TEST(GyroNodeBeforeTheFirstPulse, DiscardsTheTurnThatHadAlreadyBegun) {
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
  expect_same(turning.state(), straight.state());
}

TEST(GyroNodeBeforeTheFirstPulse, WouldHaveLearntTheTurnWithoutHoldBack) {
  auto params = node_params();
  params.standstill.hold_back = Duration{};
  Node turning{params};
  Node straight{params};
  for (Node* node : {&turning, &straight}) stand(*node, 0, 20'000);
  stand(turning, 20'000, 20'490, kBias + 0.02F);
  stand(straight, 20'000, 20'490);
  for (Node* node : {&turning, &straight}) drive(*node, 20'490, 20'500);
  for (const Predictor which :
       {Predictor::kalman, Predictor::moving_average, Predictor::calibration_mean}) {
    EXPECT_GT(bias_of(turning, which), bias_of(straight, which));
  }
}

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
  EXPECT_EQ(node.state().held.size(), 0U);
}

/// Samples that a node must refuse, after one at 20 s.
struct Refused {
  const char* name;
  drivers::GyroSample sample;
  Health health;
};

std::vector<Refused> refused_samples() {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  auto one_axis = sample_at(at_ms(20'010), kBias);
  one_axis.rate[2] = core::rad_per_s(kNaN);
  const Health no_rate{.calibrated = true, .sample_refused = true};
  const Health no_time{.calibrated = true, .time_refused = true};
  return {{"nan", sample_at(at_ms(20'010), kNaN), no_rate},
          {"nan on one axis", one_axis, no_rate},
          {"faster than anything", sample_at(at_ms(20'010), -1.1e6F), no_rate},
          {"infinite", sample_at(at_ms(20'010), kInfinity), no_rate},
          {"minus infinite", sample_at(at_ms(20'010), -kInfinity), no_rate},
          {"duplicate stamp", sample_at(at_ms(20'000), kBias), no_time},
          {"backwards", sample_at(at_ms(19'990), kBias), no_time},
          {"before the first", sample_at(at_ms(-5'000), kBias), no_time},
          {"beyond the counter", sample_at(at_ms(1'000'000'000'000), kBias), no_time}};
}

TEST(GyroNodeGivenABadSample, RefusesItFlagsItAndStaysAsItWas) {
  const auto params = node_params();
  for (const Refused& refused : refused_samples()) {
    SCOPED_TRACE(refused.name);
    Node node{params};
    stand(node, 0, 20'010);
    const Node::State before = node.state();
    const RateMessage message = node.step(refused.sample);
    EXPECT_EQ(message.health, refused.health);
    EXPECT_FALSE(message.has_rate());
    expect_same(node.state(), before);
  }
}

TEST(GyroNodeGivenBadSamplesInBetween, GoesOnAsIfTheyHadNotBeen) {
  const auto params = node_params();
  Node disturbed{params};
  Node clean{params};
  stand(disturbed, 0, 20'010);
  stand(clean, 0, 20'010);
  for (const Refused& refused : refused_samples()) (void)disturbed.step(refused.sample);
  EXPECT_EQ(stand(disturbed, 20'010, 30'000), stand(clean, 20'010, 30'000));
  expect_same(disturbed.state(), clean.state());
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
  expect_same(wild.state(), tame.state());
}

TEST(GyroNodeAfterAGapOfAnHour, KeepsItsBiasWithAWiderIntervalAndLearnsOn) {
  const auto params = node_params();
  Node node{params};
  const RateMessage before = stand(node, 0, 60'000).back();
  constexpr std::int64_t kLater = 3'660'000;
  const RateMessage after = node.step(noisy_sample(at_ms(kLater), kBias));
  EXPECT_TRUE(after.has_rate());
  EXPECT_NEAR(after.axes[0].bias.in(core::rad_per_s), kBias,
              5.0F * after.axes[0].sigma.in(core::rad_per_s));
  EXPECT_GT(after.axes[0].sigma, before.axes[0].sigma);
  const std::uint32_t learnt = node.measured_ticks();
  EXPECT_LT(stand(node, kLater + 10, kLater + 60'000).back().axes[0].sigma, after.axes[0].sigma);
  EXPECT_GT(node.measured_ticks(), learnt);
}

/// A minute and a half with two stops and two drives.
RateMessage at_step(Node& node, std::int64_t ms) {
  const bool moves = (ms >= 20'000 && ms < 40'000) || ms >= 70'000;
  if (moves) node.pulse(at_ms(ms));
  return node.step(noisy_sample(at_ms(ms), kBias + (moves ? 0.2F : 0.0F)));
}

TEST(GyroNodeRestoredFromItsState, EqualsTheUninterruptedRunBitForBit) {
  const auto params = node_params();
  // In the settle time, in a stop, in a hold-back, at a tick's edge, in a drive, in the next stop.
  for (const std::int64_t cut : {500, 10'040, 19'800, 19'990, 20'000, 30'000, 40'500, 60'100}) {
    SCOPED_TRACE(cut);
    Node whole{params};
    Node first{params};
    std::int64_t ms = 0;
    for (; ms < cut; ms += 10) EXPECT_EQ(at_step(whole, ms), at_step(first, ms));
    Node second{params};
    second.restore(first.state());
    for (; ms < 90'000; ms += 10) ASSERT_EQ(at_step(whole, ms), at_step(second, ms));
    expect_same(whole.state(), second.state());
  }
}

TEST(GyroNodeRestoredBetweenPulseAndSample, EqualsTheUninterruptedRunBitForBit) {
  const auto params = node_params();
  Node whole{params};
  stand(whole, 0, 20'000);
  whole.pulse(at_ms(20'000));
  Node second{params};
  second.restore(whole.state());
  EXPECT_EQ(drive(whole, 20'000, 40'000), drive(second, 20'000, 40'000));
  expect_same(whole.state(), second.state());
}

TEST(GyroNodeFedTwiceWithTheSame, SaysTheSameTwice) {
  const auto params = node_params();
  Node one{params};
  Node two{params};
  for (std::int64_t ms = 0; ms < 90'000; ms += 10) ASSERT_EQ(at_step(one, ms), at_step(two, ms));
  expect_same(one.state(), two.state());
}

TEST(GyroNodeOverAWholeDrive, NeverAllocates) {
  const auto params = node_params();
  Node node{params};
  const support::AllocationCounter allocations;
  for (std::int64_t ms = 0; ms < 90'000; ms += 10) (void)at_step(node, ms);
  node.restore(node.state());
  (void)node.predict_heading(Predictor::moving_average, 0, at_ms(70'000), at_ms(90'000));
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(GyroNodeWithABiasOfTwelveDegreesPerSecond, IsAsExactAsWithASmallOne) {
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
  const auto params = node_params();
  Node full{params};
  Node thin{params};
  stand(full, 0, 60'000);
  for (std::int64_t ms = 0; ms < 60'000; ms += 10) {
    if (ms % 100 < 50) (void)thin.step(noisy_sample(at_ms(ms), kBias));
  }
  EXPECT_EQ(thin.tick(), full.tick());
  const auto thin_mean = thin.state().axes[0].calibration_mean;
  const auto full_mean = full.state().axes[0].calibration_mean;
  EXPECT_EQ(thin_mean.count, full_mean.count);
  EXPECT_FLOAT_EQ(thin_mean.white_variance_sum, 2.0F * full_mean.white_variance_sum);
  EXPECT_NEAR(bias_of(thin, Predictor::kalman), kBias, 5.0F * kWhiteSigmaRadS / std::sqrt(2900.F));
}

TEST(GyroNodeWithoutTemperature, IsTheSame) {
  const auto params = node_params();
  Node with{params};
  Node without{params};
  for (std::int64_t ms = 0; ms < 20'000; ms += 10) {
    auto sample = noisy_sample(at_ms(ms), kBias);
    const RateMessage cold = without.step(sample);
    sample.has_temperature = true;
    sample.temperature = core::Temperature::from_degc(60.0F);
    ASSERT_EQ(with.step(sample), cold);
  }
}

/// A node that follows the temperature, from the one of node_params().
GyroNode<4, 0, 2>::Params warm_params() {
  const auto plain = node_params();
  GyroNode<4, 0, 2>::Params params{.modes = plain.modes,
                                   .white_variance_rad2_s2 = plain.white_variance_rad2_s2,
                                   .sample_period = plain.sample_period};
  params.temperature = {.reference_degc = 30.0F, .slope_sigma_rad_s_per_k = 1e-2F};
  return params;
}

/// In minutes of standstill and of driving in turn; the temperature rises by a kelvin a minute, the
/// bias of x, y and z by 1, 2 and 3 times 1e-3 rad/s/K.
drivers::GyroSample warming_sample(std::int64_t ms) {
  constexpr float kSlope = 1e-3F;
  const float excess = static_cast<float>(ms) / 60'000.0F - 10.0F;
  auto sample = noisy_sample(at_ms(ms), kBias + kSlope * excess);
  sample.has_temperature = true;
  sample.temperature = core::Temperature::from_degc(30.0F + excess);
  return sample;
}
RateMessage warming_step(GyroNode<4, 0, 2>& node, std::int64_t ms) {
  if (ms / 60'000 % 2 == 1) node.pulse(at_ms(ms));
  return node.step(warming_sample(ms));
}

TEST(GyroNodeThatFollowsTheTemperature, LearnsTheSlopeAcrossStops) {
  const auto params = warm_params();
  GyroNode<4, 0, 2> node{params};
  std::int64_t ms = 0;
  for (; ms < 600'000; ms += 10) (void)warming_step(node, ms);
  // At the end of the sixth drive, a minute and a kelvin after it was measured.
  const RateMessage message = warming_step(node, ms - 10 + 60'000);
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
  const auto params = warm_params();
  for (const std::int64_t cut : {30'050, 60'000, 119'990, 150'000}) {
    GyroNode<4, 0, 2> whole{params};
    std::int64_t ms = 0;
    for (; ms < cut; ms += 10) (void)warming_step(whole, ms);
    GyroNode<4, 0, 2> second{params};
    second.restore(whole.state());
    for (; ms < 240'000; ms += 10) ASSERT_EQ(warming_step(whole, ms), warming_step(second, ms));
  }
}

TEST(GyroNodeWhoseThermometerFallsSilent, SaysSoAndWidensItsInterval) {
  const auto params = warm_params();
  GyroNode<4, 0, 2> node{params};
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

/// A node that looks at single samples: one in a thousand is wild.
using ScreeningNode = GyroNode<4, 0, 0, NodeCapacity{.screens_samples = true}>;
ScreeningNode::Params screening_params() {
  auto params = node_params();
  params.samples.outliers = {.probability = 1e-3F,
                             .variance_rad2_s2 = 1e4F * kWhiteSigmaRadS * kWhiteSigmaRadS};
  return params;
}

/// From 10 s on every 50th sample is off by 200 standard deviations on y.
bool is_wild(std::int64_t ms) {
  return ms > 10'000 && ms % 500 == 250;
}
drivers::GyroSample sometimes_wild_sample(std::int64_t ms) {
  auto sample = noisy_sample(at_ms(ms), kBias);
  if (is_wild(ms)) sample.rate[1] = sample.rate[1] + core::rad_per_s(200.0F * kWhiteSigmaRadS);
  return sample;
}

TEST(GyroNodeThatScreensSamples, LearnsNothingFromWildOnesAndSaysSo) {
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
  params.samples.level = {.variance = 0.1F, .time_constants_per_tick = 1e-2F};
  params.samples.motion = {
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
  params.samples = {};
  params.samples.level = {.variance = 1.0F, .time_constants_per_tick = 1e-3F};
  for (auto& mode : params.modes.decaying) {  // as good as none, so that the mean is all
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

TEST(GyroNodeThatKnowsItsRange, SaysWhenASampleIsAtItsEnd) {
  auto params = node_params();
  params.samples.range = {.lower_rad_s = -1.0F, .upper_rad_s = 1.0F};
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

TEST(GyroNodeWithoutTheBlock, IsNotLargerForIt) {
  static_assert(sizeof(GyroNode<4, 0>::HeldTick) == sizeof(core::TickMean<3>));
  static_assert(std::is_empty_v<core::TemperatureTrack<0>>);
  static_assert(sizeof(core::KalmanPredictor<6, 0, 0>::State) <= 192);
  EXPECT_LT(sizeof(GyroNode<4, 0>), sizeof(GyroNode<4, 0, 2>));
}

TEST(GyroNodeWithAGate, SaysThatItDoubtsAMeasurementUntilOneAgrees) {
  auto params = node_params();
  params.gate = {.threshold_sigma = 6.0F, .longest_knock_ticks = 50};
  Node node{params};
  EXPECT_FALSE(stand(node, 0, 10'000).back().health.measurement_rejected);
  // A knock of three ticks, held back for half a second and too small for a turn.
  stand(node, 10'000, 10'300, kBias + 0.0015F);
  EXPECT_TRUE(stand(node, 10'300, 10'800).back().health.measurement_rejected);
  EXPECT_FALSE(stand(node, 10'800, 12'000).back().health.measurement_rejected);
}

TEST(GyroNodeWithASaturatedSample, PublishesItFlaggedAndDoesNotLearnFromIt) {
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
    expect_same(node.state().axes[i].kalman, never.state().axes[i].kalman);
    expect_same(node.state().axes[i].calibration_mean, never.state().axes[i].calibration_mean);
  }
}

TEST(GyroNodeBuiltToPublishAPredictor, CorrectsByThatOne) {
  for (const Predictor which :
       {Predictor::kalman, Predictor::moving_average, Predictor::calibration_mean}) {
    auto params = node_params();
    params.published = which;
    Node node{params};
    stand(node, 0, 20'000);
    const RateMessage message = drive(node, 20'000, 20'010).back();
    EXPECT_EQ(message.axes[0].bias, node.bias(which, 0));
    EXPECT_EQ(message.axes[0].sigma.in(core::rad_per_s), node.predict(which, 0).sigma_rad_s());
  }
}

TEST(GyroNodeWhoseSensorIsLouderThanItsModel, SaysThatTheModelIsInconsistent) {
  auto params = node_params();
  Node honest{params};
  EXPECT_FALSE(stand(honest, 0, 60'000).back().health.model_inconsistent);
  params.white_variance_rad2_s2 *= 0.25F;
  Node deceived{params};
  EXPECT_TRUE(stand(deceived, 0, 60'000).back().health.model_inconsistent);
}

TEST(GyroNodeParams, AreCheckedOneByOne) {
  EXPECT_TRUE(Node::check(node_params()).has_value());
  const auto error = [](auto spoil) {
    auto params = node_params();
    spoil(params);
    const auto checked = Node::check(params);
    EXPECT_FALSE(checked.has_value());
    return checked.error();
  };
  using Params = Node::Params;
  EXPECT_EQ(error([](Params& p) { p.modes.tick = Duration{}; }), ParamsError::tick_not_positive);
  EXPECT_EQ(error([](Params& p) { p.sample_period = Duration{}; }), ParamsError::tick_not_positive);
  EXPECT_EQ(error([](Params& p) { p.sample_period = p.modes.tick * 2; }),
            ParamsError::tick_shorter_than_sample);
  for (const float variance : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(),
                               std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(error([&](Params& p) { p.white_variance_rad2_s2 = variance; }),
              ParamsError::white_variance_not_positive);
  }
  EXPECT_EQ(error([](Params& p) { p.standstill.settle = Duration::nanoseconds(-1); }),
            ParamsError::negative_time);
  EXPECT_EQ(error([](Params& p) { p.standstill.hold_back = Duration::nanoseconds(-1); }),
            ParamsError::negative_time);
  EXPECT_EQ(error([](Params& p) { p.standstill.hold_back = p.modes.tick * 63; }),
            ParamsError::hold_back_too_long);
}

TEST(GyroNodeWithTheLongestHoldBack, NeverOverfillsItsLine) {
  auto params = node_params();
  params.standstill.hold_back = Duration::nanoseconds((params.modes.tick * 63).ns() - 1);
  ASSERT_TRUE(Node::check(params).has_value());
  Node node{params};
  stand(node, 0, 30'000);
  EXPECT_GT(node.measured_ticks(), 0U);
}

}  // namespace
}  // namespace zerorate::app

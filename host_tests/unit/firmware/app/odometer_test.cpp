// The node whose odometer fails: its messages, and that it learns nothing from it.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

using testing::at_ms;
using testing::expect_same;
using testing::Node;
using testing::node_params;
using testing::noisy_sample;

constexpr float kBias = 0.01F;
constexpr float kDps = 0.01745329F;

/// A node and the samples of its gyro, one after another every 10 ms.
class Trip {
 public:
  explicit Trip(const Node::Params& params = node_params()) : params_(params) {}

  /// Turns about x at this rate; the newest message.
  RateMessage go(std::int64_t ms, float turn_rad_s, bool pulses) {
    RateMessage message;
    for (const std::int64_t end_ms = now_ms_ + ms; now_ms_ < end_ms; now_ms_ += 10) {
      if (pulses) node_.pulse(at_ms(now_ms_));
      auto sample = noisy_sample(at_ms(now_ms_), kBias);
      sample.rate[0] = sample.rate[0] + core::rad_per_s(turn_rad_s);
      message = node_.step(sample);
      if (!message.health.odometer_disagreement) agreed_ms_ = now_ms_;
    }
    return message;
  }
  RateMessage stand(std::int64_t ms) { return go(ms, 0.0F, false); }
  [[nodiscard]] Node& node() { return node_; }
  [[nodiscard]] std::int64_t agreed_ms() const { return agreed_ms_; }

 private:
  Node::Params params_;
  Node node_{params_};
  std::int64_t now_ms_ = 0;
  std::int64_t agreed_ms_ = 0;
};

float error_dps(const Node& node) {
  return (node.bias(Predictor::kalman, 0).in(core::rad_per_s)-kBias) / kDps;
}

/// Verifies SR-LEARN-05, SR-HEALTH-15.
TEST(GyroNodeWhoseOdometerIsDead, ReportsATurnAndDoesNotLearnIt) {
  Trip trip;
  const Node& node = trip.node();
  EXPECT_FALSE(trip.stand(60'000).health.odometer_disagreement);
  const std::uint32_t learnt = node.measured_ticks();
  const RateMessage turning = trip.go(60'000, kDps, false);
  EXPECT_LE(trip.agreed_ms(), 61'000);
  EXPECT_TRUE(turning.health.odometer_disagreement);
  EXPECT_EQ(turning.motion, core::Motion::settling);
  EXPECT_LE(node.measured_ticks(), learnt + 5);  // ticks that were held back when the turn began
  EXPECT_LT(std::abs(error_dps(node)), 0.005F);
  const RateMessage after = trip.stand(10'000);
  EXPECT_FALSE(after.health.odometer_disagreement);
  EXPECT_EQ(after.motion, core::Motion::still);
  EXPECT_GT(node.measured_ticks(), learnt + 60);
}

// Nobody can tell a constant turn from a bias; but no bias of this chip is so large.
/// Verifies SR-HEALTH-05.
TEST(GyroNodeStartedInAFastTurn, IsNeverHealthy) {
  auto params = node_params();
  params.model.largest_bias_rad_s = 5.0F * kDps;
  for (const float turn_dps : {-8.0F, 5.5F, 20.0F}) {
    Trip trip{params};
    for (int second = 0; second < 60; ++second) {
      const Health health = trip.go(1'000, turn_dps * kDps, false).health;
      EXPECT_TRUE(!health.calibrated || health.model_inconsistent) << turn_dps << ", " << second;
    }
  }
  EXPECT_FALSE(Trip{params}.go(60'000, 3.0F * kDps, false).health.model_inconsistent);
}

/// Verifies SR-LEARN-07.
TEST(GyroNodeWhoseWireBreaksInABend, LearnsNothingOfIt) {
  Trip trip;
  const Node& node = trip.node();
  trip.stand(60'000);
  trip.go(20'000, 10.0F * kDps, true);
  for (int bend = 0; bend < 20; ++bend) {
    const float turn = 10.0F + static_cast<float>(bend % 4);
    EXPECT_EQ(trip.go(1'000, turn * kDps, false).health.odometer_disagreement, bend > 0) << bend;
  }
  EXPECT_LT(std::abs(error_dps(node)), 0.005F);
}

/// Verifies SR-LEARN-06.
TEST(GyroNodeWhoseBiasIsAnotherAfterADrive, AcceptsItIn2Minutes) {
  Trip trip;
  const Node& node = trip.node();
  trip.stand(60'000);
  trip.go(60'000, 10.0F * kDps, true);
  EXPECT_TRUE(trip.go(115'000, 1.3F * kDps, false).health.odometer_disagreement);
  EXPECT_FALSE(trip.go(30'000, 1.3F * kDps, false).health.odometer_disagreement);
  EXPECT_NEAR(error_dps(node), 1.3F, 0.005F);
}

// The bias changes half a minute before the vehicle drives off.
/// Verifies SR-HEALTH-19.
TEST(GyroNodeThatDoubtsAtDeparture, SaysSoUntilAStopSettlesIt) {
  Trip trip;
  const Node& node = trip.node();
  trip.stand(60'000);
  trip.go(30'000, 0.5F * kDps, false);
  for (int second = 0; second < 300; ++second) {
    const float turn = static_cast<float>(second % 5);
    EXPECT_TRUE(trip.go(1'000, (0.5F + turn) * kDps, true).health.odometer_disagreement) << second;
  }
  EXPECT_TRUE(trip.go(80'000, 0.5F * kDps, false).health.odometer_disagreement);
  EXPECT_FALSE(trip.go(30'000, 0.5F * kDps, false).health.odometer_disagreement);
  EXPECT_NEAR(error_dps(node), 0.5F, 0.005F);
}

// An automated vehicle turns on the spot for five minutes, and then stands.
/// Verifies SR-LEARN-08.
TEST(GyroNodeThatLearntATurn, ReturnsToTheBiasWithinSeconds) {
  Trip trip;
  const Node& node = trip.node();
  trip.stand(60'000);
  trip.go(300'000, 3.0F * kDps, false);
  EXPECT_NEAR(error_dps(node), 3.0F, 0.01F);
  EXPECT_FALSE(trip.stand(15'000).health.odometer_disagreement);
  EXPECT_NEAR(error_dps(node), 0.0F, 0.01F);
}

/// Verifies SR-HEALTH-16.
TEST(GyroNodeWithPulsesAtRest, SaysSoAndCalibratesAtTheNextStop) {
  Trip trip;
  const Node& node = trip.node();
  trip.stand(20'000);
  EXPECT_FALSE(trip.go(110'000, 0.0F, true).health.odometer_disagreement);
  EXPECT_TRUE(trip.go(60'000, 0.0F, true).health.odometer_disagreement);
  const std::uint32_t learnt = node.measured_ticks();
  EXPECT_FALSE(trip.stand(20'000).health.odometer_disagreement);
  EXPECT_GT(node.measured_ticks(), learnt + 180);
}

// Stamps that lie ahead are believed: what they cost is bounded by the stamp, and told.
constexpr std::int64_t kAhead_ms = 600'000;

/// Verifies SR-TIME-06.
TEST(GyroNodeWithAPulseStampedAhead, ReportsItAndRecovers) {
  Trip trip;
  Node& node = trip.node();
  trip.stand(20'000);
  const std::uint32_t learnt = node.measured_ticks();
  node.pulse(at_ms(20'000 + kAhead_ms));
  EXPECT_FALSE(trip.stand(110'000).health.odometer_disagreement);
  const RateMessage waiting = trip.stand(20'000);
  EXPECT_TRUE(waiting.health.odometer_disagreement);
  EXPECT_EQ(waiting.motion, core::Motion::moving);
  trip.stand(kAhead_ms - 130'000);
  EXPECT_LE(node.measured_ticks(), learnt + 20);  // ticks that were held back when it came
  const RateMessage after = trip.stand(30'000);
  EXPECT_FALSE(after.health.odometer_disagreement);
  EXPECT_EQ(after.motion, core::Motion::still);
  EXPECT_GE(node.measured_ticks(), (20'000 + kAhead_ms + 25'000) / 100);
}

/// Verifies SR-TIME-06.
TEST(GyroNodeWithASampleStampedAhead, RefusesUntilItsTime) {
  Trip trip;
  Node& node = trip.node();
  trip.stand(20'000);
  EXPECT_FALSE(node.step(noisy_sample(at_ms(20'000 + kAhead_ms), kBias)).health.time_refused);
  const std::uint32_t learnt = node.measured_ticks();
  for (std::int64_t waited_ms = 0; waited_ms < kAhead_ms; waited_ms += 10'000) {
    EXPECT_TRUE(trip.stand(10'000).health.time_refused) << waited_ms;
  }
  EXPECT_EQ(node.measured_ticks(), learnt);
  trip.stand(10);  // its own time, once more
  EXPECT_FALSE(trip.stand(30'000).health.time_refused);
  EXPECT_GE(node.measured_ticks(), (20'000 + kAhead_ms + 25'000) / 100);
}

TEST(GyroNodeRestoredInATurnWithoutPulses, GoesOnAsTheOtherWould) {
  Trip trip;
  Node& node = trip.node();
  trip.stand(30'000);
  trip.go(5'000, kDps, false);
  Node other{node.params()};
  other.restore(node.state());
  for (std::int64_t ms = 35'000; ms < 45'000; ms += 10) {
    const auto sample = noisy_sample(at_ms(ms), kBias);
    ASSERT_EQ(node.step(sample), other.step(sample)) << ms;
  }
  expect_same(node.state(), other.state());
}

}  // namespace
}  // namespace zerorate::app

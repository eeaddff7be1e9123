#include "firmware/app/gyro_node.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include "firmware/app/possible_state.hpp"
#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

using core::Duration;
using testing::at_ms;
using testing::drive;
using testing::expect_same;
using testing::kBias;
using testing::kNodeShape;
using testing::Node;
using testing::node_params;
using testing::noisy_sample;
using testing::sample_at;
using testing::stand;

/// Samples that a node must refuse, after one at 20 s.
struct Refused {
  const char* name;
  core::GyroSample sample;
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

/// Verifies SR-LEARN-10, SR-HEALTH-01, SR-HEALTH-02.
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

/// Verifies SR-LEARN-10.
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

/// A minute and a half with two stops and two drives.
RateMessage at_step(Node& node, std::int64_t ms) {
  const bool moves = (ms >= 20'000 && ms < 40'000) || ms >= 70'000;
  if (moves) node.pulse(at_ms(ms));
  return node.step(noisy_sample(at_ms(ms), kBias + (moves ? 0.2F : 0.0F)));
}

/// Verifies SR-SNAP-01.
TEST(GyroNodeRestoredFromItsState, EqualsTheUninterruptedRun) {
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

TEST(GyroNodeRestoredBetweenPulseAndSample, EqualsTheFullRun) {
  const auto params = node_params();
  Node whole{params};
  stand(whole, 0, 20'000);
  whole.pulse(at_ms(20'000));
  Node second{params};
  second.restore(whole.state());
  EXPECT_EQ(drive(whole, 20'000, 40'000), drive(second, 20'000, 40'000));
  expect_same(whole.state(), second.state());
}

/// Verifies SR-PRED-10.
TEST(GyroNodeFedTwiceWithTheSame, SaysTheSameTwice) {
  const auto params = node_params();
  Node one{params};
  Node two{params};
  for (std::int64_t ms = 0; ms < 90'000; ms += 10) ASSERT_EQ(at_step(one, ms), at_step(two, ms));
  expect_same(one.state(), two.state());
}

/// Verifies SR-MEM-01.
TEST(GyroNodeOverAWholeDrive, NeverAllocates) {
  const auto params = node_params();
  Node node{params};
  const support::AllocationCounter allocations;
  for (std::int64_t ms = 0; ms < 90'000; ms += 10) (void)at_step(node, ms);
  node.restore(node.state());
  (void)node.predict_heading(Predictor::moving_average, 0, at_ms(70'000), at_ms(90'000));
  EXPECT_EQ(allocations.count(), 0U);
}

TEST(GyroNodeWithoutTheBlock, IsNotLargerForIt) {
  static_assert(sizeof(Node::Ticks::Tick) == sizeof(core::TickMean<3>));
  static_assert(std::is_empty_v<Node::InputTrack>);
  EXPECT_LT(sizeof(Node), sizeof(GyroNode<core::ModelShape{.decaying = 4, .inputs = 2}>));
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
  EXPECT_EQ(error([](Params& p) { p.model.modes.tick = Duration{}; }),
            ParamsError::tick_not_positive);
  EXPECT_EQ(error([](Params& p) { p.model.sample_period = Duration{}; }),
            ParamsError::tick_not_positive);
  EXPECT_EQ(error([](Params& p) { p.model.sample_period = p.model.modes.tick * 2; }),
            ParamsError::tick_shorter_than_sample);
  for (const float variance : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(),
                               std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(error([&](Params& p) { p.model.white_variance_rad2_s2 = variance; }),
              ParamsError::white_variance_not_positive);
  }
  EXPECT_EQ(error([](Params& p) { p.standstill.settle = Duration::nanoseconds(-1); }),
            ParamsError::negative_time);
  EXPECT_EQ(error([](Params& p) { p.standstill.hold_back = Duration::nanoseconds(-1); }),
            ParamsError::negative_time);
  EXPECT_EQ(error([](Params& p) { p.standstill.hold_back = p.model.modes.tick * 61; }),
            ParamsError::hold_back_too_long);
}

/// Verifies SR-TIME-04.
TEST(GyroNodeWithTheLongestHoldBack, NeverOverfillsItsLine) {
  auto params = node_params();
  params.standstill.hold_back = Duration::nanoseconds((params.model.modes.tick * 61).ns() - 1);
  ASSERT_TRUE(Node::check(params).has_value());
  Node node{params};
  stand(node, 0, 30'000);
  EXPECT_GT(node.measured_ticks(), 0U);
}

/// A node that runs nothing but the Kalman predictor.
using LeanNode = GyroNode<kNodeShape, NodeCapacity{.runs_moving_average = false,
                                                   .runs_calibration_mean = false}>;

TEST(GyroNodeOfTheKalmanPredictorAlone, PublishesTheSame) {
  const auto params = node_params();
  Node whole{params};
  LeanNode lean{params};
  for (std::int64_t ms = 0; ms < 30'000; ms += 10) {
    const auto sample = noisy_sample(at_ms(ms), kBias);
    ASSERT_EQ(lean.step(sample), whole.step(sample));
  }
  EXPECT_FALSE(lean.predict(Predictor::moving_average, 0).is_available());
  // Three axes of a moving average, 22 levels of 50 bytes each.
  EXPECT_LT(sizeof(LeanNode) + std::size_t{3} * 22 * 50, sizeof(Node));
}

TEST(GyroNodeOfTheKalmanPredictorAlone, RefusesToPublishAnother) {
  auto params = node_params();
  EXPECT_TRUE(LeanNode::check(params).has_value());
  params.published = Predictor::moving_average;
  EXPECT_EQ(LeanNode::check(params).error(), ParamsError::predictor_not_run);
  params.published = Predictor::calibration_mean;
  EXPECT_EQ(LeanNode::check(params).error(), ParamsError::predictor_not_run);
}

// An array of no rotating modes has a byte, and three of padding follow: no numbers.
TEST(GyroNodeState, IsPossibleWhateverItsPaddingHolds) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 10'000);
  Node::State state = node.state();
  static_assert(std::tuple_size_v<decltype(state.ticks.lead.rotating)> == 0);
  auto* const lead = reinterpret_cast<unsigned char*>(&state.ticks.lead);
  auto* const behind_the_numbers = reinterpret_cast<unsigned char*>(&state.ticks.lead.rotating);
  std::fill(behind_the_numbers, lead + sizeof(state.ticks.lead), 0xFF);
  EXPECT_TRUE(is_possible_state(node, state));
  state.ticks.lead.level.noise = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_possible_state(node, state));
}

TEST(GyroNodeState, DiffersInGateAndMonitor) {
  const auto params = node_params();
  Node node{params};
  stand(node, 0, 10'000);
  const Node::State state = node.state();
  Node::State other = state;
  EXPECT_TRUE(other == state);
  other.ticks.predictors.kalman.rejected = 1;
  EXPECT_FALSE(other == state);
  other = state;
  other.ticks.predictors.kalman.axes[1].rejection_variance = 1.0F;
  EXPECT_FALSE(other == state);
  other = state;
  other.ticks.predictors.axes[1].monitor.doubted = 1;
  EXPECT_FALSE(other == state);
}

}  // namespace
}  // namespace zerorate::app

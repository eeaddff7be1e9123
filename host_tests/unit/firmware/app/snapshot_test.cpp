#include "firmware/app/snapshot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "core/noise/terms.hpp"
#include "host_tests/support/checksum.hpp"
#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

using testing::at_ms;
using testing::Node;
using testing::noisy_sample;

constexpr std::uint32_t kSensor = 7;
constexpr float kBias_rad_s = 0.02F;
constexpr float kTurnOnSigma_rad_s = 5e-4F;

Node::Params params_with_turn_on() {
  Node::Params params = testing::node_params();
  params.model.turn_on_variance_rad2_s2 = kTurnOnSigma_rad_s * kTurnOnSigma_rad_s;
  return params;
}

/// A node after a minute of standstill.
struct Learnt {
  explicit Learnt(const Node::Params& node_params = params_with_turn_on()) : params(node_params) {
    for (std::int64_t ms = 0; ms < 60'000; ms += 10) {
      last = node.step(noisy_sample(at_ms(ms), kBias_rad_s));
    }
  }
  Node::Params params;
  Node node{params};
  Snapshot<Node> snapshot{params, kSensor};
  RateMessage last;
};

float bias_of(const Node& node) {
  return node.bias(Predictor::kalman, 0).in(core::rad_per_s);
}

constexpr SnapshotTime kSaved{.session = {'a'}, .utc_s = 1'000'000};
constexpr SnapshotTime after(std::int64_t seconds) {
  return {.session = {'b'}, .utc_s = *kSaved.utc_s + seconds};
}

template <class Record>
core::Result<Resumption, SnapshotRefusal> taken_up(const Node::Params& params, const Record& record,
                                                   const SnapshotTime& now, Node& node) {
  return Snapshot<Node>{params, kSensor}.restore(node, record, now);
}
template <class Record>
SnapshotRefusal refusal_of(const Record& record, const SnapshotTime& now,
                           const Node::Params& params = params_with_turn_on(),
                           std::uint32_t sensor = kSensor) {
  Node node{params};
  const auto restored = Snapshot<Node>{params, sensor}.restore(node, record, now);
  EXPECT_FALSE(node.predict(Predictor::kalman, 0).is_available()) << "it was touched";
  return restored.error();
}

/// Verifies SR-SNAP-01.
TEST(SnapshotOfAState, ContinuesBitForBitInTheSameSession) {
  Learnt learnt;
  const auto record = learnt.snapshot.of_state(learnt.node.state(), kSaved);
  Node again{learnt.params};
  EXPECT_EQ(*taken_up(learnt.params, record, kSaved, again), Resumption::continued);
  for (std::int64_t ms = 60'000; ms < 65'000; ms += 10) {
    const auto sample = noisy_sample(at_ms(ms), kBias_rad_s);
    ASSERT_EQ(again.step(sample), learnt.node.step(sample));
  }
}

/// Verifies SR-SNAP-02.
TEST(SnapshotAfterAPause, HasTheVarianceOfPauseAndTurnOn) {
  Learnt learnt;
  constexpr std::int64_t kPause_s = 600;
  for (const bool is_state : {false, true}) {
    Node again{learnt.params};
    const auto resumption =
        is_state ? taken_up(learnt.params, learnt.snapshot.of_state(learnt.node.state(), kSaved),
                            after(kPause_s), again)
                 : taken_up(learnt.params, learnt.snapshot.of_filters(learnt.node, kSaved),
                            after(kPause_s), again);
    EXPECT_EQ(*resumption, Resumption::aged);
    // The oracle: the same node, asked without a stop between, over the same time.
    core::KalmanCoefficients<core::ModelShape{.decaying = 4}> coefficients{
        learnt.params.model.modes};
    core::KalmanBank<core::ModelShape{.decaying = 4}, 3> oracle{coefficients};
    oracle.restore(learnt.node.predictors().filter());
    const auto ticks = learnt.node.ticks().ticks_since_measured() + kPause_s * 10 + 1;
    const auto expected =
        oracle.predict(learnt.params.model.modes.over(static_cast<std::uint32_t>(ticks)))[1];
    const auto resumed = again.predict(Predictor::kalman, 1);
    EXPECT_NEAR(resumed.bias_rad_s, expected.bias_rad_s, 1e-3F * expected.sigma_rad_s());
    EXPECT_NEAR(resumed.variance_rad2_s2,
                expected.variance_rad2_s2 + learnt.params.model.turn_on_variance_rad2_s2,
                1e-3F * expected.variance_rad2_s2);
  }
}

TEST(SnapshotAfterAPause, IsCorrectedByTheFirstStop) {
  Learnt learnt;
  Node again{learnt.params};
  ASSERT_TRUE(
      taken_up(learnt.params, learnt.snapshot.of_filters(learnt.node, kSaved), after(10), again));
  const float changed_rad_s = kBias_rad_s + 2.0F * kTurnOnSigma_rad_s;
  const auto first = again.step(noisy_sample(at_ms(0), changed_rad_s));
  EXPECT_TRUE(first.health.calibrated);
  EXPECT_NEAR(first.axes[0].bias.in(core::rad_per_s), kBias_rad_s, kTurnOnSigma_rad_s);
  RateMessage last;
  for (std::int64_t ms = 10; ms < 60'000; ms += 10) {
    last = again.step(noisy_sample(at_ms(ms), changed_rad_s));
  }
  EXPECT_NEAR(last.axes[0].bias.in(core::rad_per_s), changed_rad_s,
              4.0F * last.axes[0].sigma.in(core::rad_per_s));
  EXPECT_LT(last.axes[0].sigma.in(core::rad_per_s), kTurnOnSigma_rad_s);
}

// 2^32 ticks of 5 ms are 249 days; what is aged stops at 2^30, and never becomes young again.
TEST(SnapshotAfterAPauseOfMoreTicksThanAreCounted, IsAgedByThem) {
  Node::Params params = params_with_turn_on();
  params.model.modes =
      core::compose(core::Duration::milliseconds(5), core::Start::stationary,
                    zerorate::testing::flicker_like<4>(core::Duration::milliseconds(5), 0.5),
                    core::RandomWalk{.coefficient_rad_s_sqrt_s = 1e-6F});
  params.model.sample_period = core::Duration::milliseconds(5);
  params.standstill.hold_back = core::Duration::milliseconds(200);  // equals the ticks held
  Node node{params};
  for (std::int64_t ms = 0; ms < 30'000; ms += 5) {
    (void)node.step(noisy_sample(at_ms(ms), kBias_rad_s));
  }
  const auto record = Snapshot<Node>{params, kSensor}.of_filters(node, kSaved);
  float before = 0.0F;
  for (const std::int64_t pause_s : {100'000LL, 21'474'835LL, 21'474'840LL, 30'000'000LL}) {
    Node again{params};
    ASSERT_TRUE(taken_up(params, record, after(pause_s), again)) << pause_s;
    const float variance = again.predict(Predictor::kalman, 0).variance_rad2_s2;
    EXPECT_GE(variance, before) << pause_s;
    before = variance;
  }
}

/// Verifies SR-SNAP-03.
TEST(SnapshotWithoutAClock, IsAgedByADay) {
  Learnt learnt;
  const auto record = learnt.snapshot.of_filters(learnt.node, {});
  Node without{learnt.params};
  EXPECT_EQ(*taken_up(learnt.params, record, {}, without), Resumption::aged_by_a_day);
  Node with{learnt.params};
  ASSERT_TRUE(taken_up(learnt.params, learnt.snapshot.of_filters(learnt.node, kSaved),
                       after(86'400), with));
  EXPECT_EQ(without.predict(Predictor::kalman, 2).variance_rad2_s2,
            with.predict(Predictor::kalman, 2).variance_rad2_s2);
}

TEST(SnapshotWhoseClockWentBackwards, IsAgedByADay) {
  Learnt learnt;
  Node again{learnt.params};
  EXPECT_EQ(
      *taken_up(learnt.params, learnt.snapshot.of_filters(learnt.node, kSaved), after(-1), again),
      Resumption::aged_by_a_day);
}

TEST(SnapshotWhoseClockShowsATimeBefore1970, IsAgedByADay) {
  Learnt learnt;
  constexpr SnapshotTime kUnset{.utc_s = -9'000'000'000'000'000'000};
  Node again{learnt.params};
  EXPECT_EQ(
      *taken_up(learnt.params, learnt.snapshot.of_filters(learnt.node, kUnset), kSaved, again),
      Resumption::aged_by_a_day);
}

TEST(SnapshotOfABoardThatKnowsNoSession, IsNeverContinued) {
  Learnt learnt;
  const SnapshotTime unknown{.utc_s = 5};
  Node again{learnt.params};
  EXPECT_EQ(*taken_up(learnt.params, learnt.snapshot.of_state(learnt.node.state(), unknown),
                      unknown, again),
            Resumption::aged);
}

TEST(SnapshotWithOneWrongBit, IsRefusedWhereverItIs) {
  Learnt learnt;
  auto record = learnt.snapshot.of_filters(learnt.node, kSaved);
  for (std::size_t bit = 0; bit < 8 * record.size(); bit += 7) {
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    record[bit / 8] ^= mask;
    const auto refusal = refusal_of(record, after(10));
    EXPECT_EQ(refusal, bit < 32 ? SnapshotRefusal::not_a_snapshot : SnapshotRefusal::damaged);
    record[bit / 8] ^= mask;
  }
}

TEST(SnapshotOfAnUnknownContent, IsRefusedThoughItsChecksumIsRight) {
  constexpr std::size_t kContentAt = 6;
  Learnt learnt;
  auto record = learnt.snapshot.of_filters(learnt.node, kSaved);
  record[kContentAt] = 2;
  zerorate::testing::put_checksum(record);
  EXPECT_EQ(refusal_of(record, after(10)), SnapshotRefusal::not_a_snapshot);
}

/// Random bytes or words anywhere behind the header of a record, and the checksum that they need.
template <class Record>
void forge(Record& record, std::mt19937& random) {
  constexpr std::size_t kHeader = 64;
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>{0, n - 1}(random);
  };
  for (std::size_t change = 0; change <= below(3); ++change) {
    const std::size_t length = below(2) == 0 ? 1 : 4;
    const std::size_t at = kHeader + below(record.size() - kHeader - 4 - length);
    for (std::size_t i = 0; i < length; ++i) record[at + i] = static_cast<std::uint8_t>(below(256));
  }
  zerorate::testing::put_checksum(record);
}

/// Whether it was taken up; then a minute of samples gives figures that are numbers.
template <class Record>
bool publishes_numbers_if_taken_up(const Node::Params& params, const Record& record) {
  Node node{params};
  if (!taken_up(params, record, kSaved, node)) {
    EXPECT_FALSE(node.predict(Predictor::kalman, 0).is_available()) << "it was touched";
    return false;
  }
  for (std::int64_t ms = 60'000; ms < 120'000; ms += 50) {
    const RateMessage message = node.step(noisy_sample(at_ms(ms), kBias_rad_s));
    for (const AxisRate& axis : message.axes) {
      EXPECT_TRUE(std::isfinite(axis.bias.in(core::rad_per_s)));
      const float sigma = axis.sigma.in(core::rad_per_s);
      EXPECT_TRUE(!message.health.calibrated || (std::isfinite(sigma) && sigma >= 0.0F)) << sigma;
    }
  }
  return true;
}

TEST(SnapshotOfImpossibleContent, IsRefusedWithARightChecksum) {
  Learnt learnt;
  std::mt19937 random(5);
  const auto state = learnt.snapshot.of_state(learnt.node.state(), kSaved);
  const auto filters = learnt.snapshot.of_filters(learnt.node, kSaved);
  int taken_up = 0;
  for (int k = 0; k < 500; ++k) {
    auto forged_state = state;
    forge(forged_state, random);
    taken_up += publishes_numbers_if_taken_up(learnt.params, forged_state) ? 1 : 0;
    auto forged_filters = filters;
    forge(forged_filters, random);
    taken_up += publishes_numbers_if_taken_up(learnt.params, forged_filters) ? 1 : 0;
  }
  // Most of a number's bits are possible either way; most of its exponents are not.
  EXPECT_GT(taken_up, 0);
  EXPECT_LT(taken_up, 1000);
}

TEST(SnapshotWhoseFilterIsImpossible, SaysSo) {
  Learnt learnt;
  constexpr std::size_t kBiasVarianceAt = 64 + 24 + 4 + 3 * 8;
  for (const float impossible : {-1.0F, NAN, INFINITY, 1e20F}) {
    auto record = learnt.snapshot.of_filters(learnt.node, kSaved);
    const auto bytes = std::bit_cast<std::array<std::uint8_t, 4>>(impossible);
    std::ranges::copy(bytes, record.begin() + kBiasVarianceAt);
    zerorate::testing::put_checksum(record);
    EXPECT_EQ(refusal_of(record, after(10)), SnapshotRefusal::impossible) << impossible;
  }
}

TEST(SnapshotThatDoesNotFit, IsRefusedWithTheReason) {
  Learnt learnt;
  const auto record = learnt.snapshot.of_filters(learnt.node, kSaved);
  for (std::size_t size = 0; size < record.size(); ++size) {
    const auto refusal = refusal_of(std::span{record}.first(size), after(10));
    EXPECT_EQ(refusal, size < 92 ? SnapshotRefusal::not_a_snapshot : SnapshotRefusal::damaged);
  }
  EXPECT_EQ(refusal_of(record, after(10), params_with_turn_on(), kSensor + 1),
            SnapshotRefusal::other_sensor);
  const Node::Params params = params_with_turn_on();
  Node fresh{params};
  EXPECT_EQ(refusal_of(learnt.snapshot.of_filters(fresh, kSaved), after(10)),
            SnapshotRefusal::nothing_learnt);
}

TEST(SnapshotOfAModelWithoutTurnOn, IsRefusedInAnotherSession) {
  const Node::Params params = testing::node_params();
  Learnt learnt{params};
  const auto record = learnt.snapshot.of_state(learnt.node.state(), kSaved);
  EXPECT_EQ(refusal_of(record, after(10), params), SnapshotRefusal::turn_on_unknown);
  Node again{params};
  EXPECT_EQ(*taken_up(params, record, kSaved, again), Resumption::continued);
}

// Oracle: the new amplitude's variance is whole at the start, and gone when the warm-up is over.
TEST(SnapshotOfAModelWithAWarmUp, ExpectsAnotherWarmUp) {
  constexpr float kAmplitude_rad_s = 4e-3F;
  Node::Params params = params_with_turn_on();
  params.model.modes =
      core::compose(params.model.modes.tick, core::Start::stationary,
                    core::FlickerDecades<3>{.time_constant_s = {1.0F, 10.0F, 100.0F},
                                            .variance_rad2_s2 = {1e-10F, 1e-10F, 1e-10F}},
                    core::WarmUp{.sigma_rad_s = kAmplitude_rad_s, .time_constant_s = 20.0F});
  Learnt learnt{params};
  Node again{params};
  EXPECT_EQ(*taken_up(params, learnt.snapshot.of_filters(learnt.node, kSaved), after(10), again),
            Resumption::aged);
  const float variance =
      kAmplitude_rad_s * kAmplitude_rad_s + params.model.turn_on_variance_rad2_s2;
  EXPECT_NEAR(again.predict(Predictor::kalman, 0).variance_rad2_s2 / variance, 1.0F, 0.1F);
  EXPECT_NEAR(bias_of(again), kBias_rad_s, 5e-4F);
  RateMessage last;
  for (std::int64_t ms = 0; ms < 120'000; ms += 10) {
    const float warm_up_rad_s = 2e-3F * std::exp(-static_cast<float>(ms) / 20'000.0F);
    last = again.step(noisy_sample(at_ms(ms), kBias_rad_s + warm_up_rad_s));
  }
  EXPECT_EQ(last.health, Health{.calibrated = true});
  EXPECT_NEAR(bias_of(again), kBias_rad_s, 5.0F * last.axes[0].sigma.in(core::rad_per_s));
}

// Oracle: variance of the bias, of so many seconds of the new model's slow noise, of the turn-on.
/// Verifies SR-SNAP-07.
TEST(SnapshotOfAnotherModel, GivesTheBiasWithAWiderInterval) {
  Learnt learnt;
  Node::Params louder = params_with_turn_on();
  louder.model.white_variance_rad2_s2 *= 2.0F;
  Node aged{learnt.params};
  ASSERT_EQ(
      *taken_up(learnt.params, learnt.snapshot.of_filters(learnt.node, kSaved), after(60), aged),
      Resumption::aged);
  for (const bool is_state : {false, true}) {
    Node again{louder};
    const auto resumed =
        is_state
            ? taken_up(louder, learnt.snapshot.of_state(learnt.node.state(), kSaved), after(60),
                       again)
            : taken_up(louder, learnt.snapshot.of_filters(learnt.node, kSaved), after(60), again);
    ASSERT_EQ(*resumed, Resumption::bias_alone);
    const auto known = aged.predict(Predictor::kalman, 0);
    const auto taken = again.predict(Predictor::kalman, 0);
    EXPECT_NEAR(taken.bias_rad_s, known.bias_rad_s, known.sigma_rad_s());
    EXPECT_GE(taken.variance_rad2_s2, known.variance_rad2_s2);
    EXPECT_TRUE(again.predictors().has_learnt());
  }
}

TEST(SnapshotOfAnotherModel, IsRefusedWhereItsBiasesAreNoNumbers) {
  constexpr std::size_t kBiasesAt = 64;
  Learnt learnt;
  Node::Params louder = params_with_turn_on();
  louder.model.white_variance_rad2_s2 *= 2.0F;
  for (const std::size_t number : {0U, 1U, 2U, 3U, 5U}) {
    auto record = learnt.snapshot.of_filters(learnt.node, kSaved);
    for (std::size_t byte = 0; byte < 4; ++byte) record[kBiasesAt + 4 * number + byte] = 0xFF;
    zerorate::testing::put_checksum(record);
    EXPECT_EQ(refusal_of(record, after(10), louder), SnapshotRefusal::not_a_snapshot);
  }
}

TEST(SnapshotOfAModelWithAnotherGate, IsTakenUp) {
  Learnt learnt;
  Node::Params stricter = params_with_turn_on();
  stricter.model.gate = {.threshold_sigma = 4.0F, .longest_knock_ticks = 3};
  stricter.model.turn_on_variance_rad2_s2 *= 4.0F;
  Node again{stricter};
  EXPECT_EQ(*taken_up(stricter, learnt.snapshot.of_filters(learnt.node, kSaved), after(10), again),
            Resumption::aged);
}

TEST(SnapshotOfASingleMeasurement, IsRefusedAsUnconfirmed) {
  const Node::Params params = params_with_turn_on();
  Node node{params};
  for (std::int64_t ms = 0; ms < 2'300; ms += 10) {
    (void)node.step(noisy_sample(at_ms(ms), kBias_rad_s));
  }
  ASSERT_TRUE(node.predict(Predictor::kalman, 0).is_available());
  const auto record = Snapshot<Node>{params, kSensor}.of_filters(node, kSaved);
  EXPECT_EQ(refusal_of(record, after(10)), SnapshotRefusal::nothing_learnt);
}

TEST(SnapshotOfANodeThatWaitedLonger, IsTakenUp) {
  Learnt learnt;
  Node::Params patient = params_with_turn_on();
  patient.standstill.settle = core::Duration::seconds(3);
  patient.standstill.slowest = core::Duration::seconds(20);
  patient.odometer.turn_rad_s *= 2.0F;
  Node again{patient};
  EXPECT_EQ(*taken_up(patient, learnt.snapshot.of_filters(learnt.node, kSaved), after(10), again),
            Resumption::aged);
}

}  // namespace
}  // namespace zerorate::app

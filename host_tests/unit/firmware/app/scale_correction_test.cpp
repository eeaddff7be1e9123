// Known errors of the scale factors, which a node takes off its samples.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "firmware/app/snapshot.hpp"
#include "host_tests/unit/firmware/app/node_rig.hpp"

namespace zerorate::app {
namespace {

using testing::at_ms;
using testing::Node;
using testing::noisy_sample;

/// Last message of a stop and a drive with a turn about axis z, of a sensor whose scale factor
/// there is off by `error`, in a node that takes `known` for it.
RateMessage drive_of_a_sensor_that_is_off(float error, float known) {
  auto params = testing::node_params();
  params.model.scale.factor[2] = core::ScaleCorrection::factor_of(known);
  Node node{params};
  RateMessage message;
  for (std::int64_t ms = 0; ms < 30'000; ms += 10) {
    const bool moves = ms >= 20'000;
    if (moves) node.pulse(at_ms(ms));
    core::GyroSample sample = noisy_sample(at_ms(ms), testing::kBias + (moves ? 0.1F : 0.0F));
    sample.rate[2] = sample.rate[2] * (1.0F + error);
    message = node.step(sample);
    EXPECT_EQ(message.axes[2].measured, sample.rate[2]);
  }
  return message;
}

/// Verifies SR-PRED-01.
TEST(KnownErrorOfTheScaleFactor, IsTakenOffBiasRateAndTurn) {
  const auto turn = [](const RateMessage& message) { return message.turn[2].angle.in(core::rad); };
  const RateMessage perfect = drive_of_a_sensor_that_is_off(0.0F, 0.0F);
  const RateMessage off = drive_of_a_sensor_that_is_off(0.02F, 0.0F);
  const RateMessage corrected = drive_of_a_sensor_that_is_off(0.02F, 0.02F);
  EXPECT_NEAR(turn(perfect), 3.0F, 0.01F);
  EXPECT_NEAR(turn(off), 1.02F * turn(perfect), 1e-3F);
  EXPECT_NEAR(turn(corrected), turn(perfect), 1e-5F);
  for (const auto figure : {&AxisRate::bias, &AxisRate::corrected, &AxisRate::sigma}) {
    EXPECT_NEAR((corrected.axes[2].*figure).in(core::rad_per_s),
                (perfect.axes[2].*figure).in(core::rad_per_s), 1e-6F);
  }
}

TEST(ScaleCorrectionThatIsOff, KeepsTheBitsOfARate) {
  constexpr core::ScaleCorrection kNone;
  EXPECT_FALSE(kNone.is_on());
  EXPECT_EQ(core::ScaleCorrection::factor_of(0.0F), 1.0F);
  for (const float rate : {0.0F, 1e-40F, 0.1F, -3.3F}) {
    EXPECT_EQ(kNone.corrected(core::rad_per_s(rate), 0), core::rad_per_s(rate));
  }
}

TEST(SnapshotOfAnotherScaleFactor, GivesTheBiasOnTheScaleOfTheChip) {
  constexpr SnapshotTime kSaved{.session = {'a'}, .utc_s = 1'000'000};
  constexpr SnapshotTime kLater{.session = {'b'}, .utc_s = 1'000'010};
  Node::Params unknown = testing::node_params();
  unknown.model.turn_on_variance_rad2_s2 = 1e-6F;
  Node::Params known = unknown;
  known.model.scale.factor[1] = 0.98F;
  Node learnt{known};
  testing::stand(learnt, 0, 60'000);
  const auto record = Snapshot<Node>{known, 7}.of_filters(learnt, kSaved);
  Node node{unknown};
  const auto restored = Snapshot<Node>{unknown, 7}.restore(node, record, kLater);
  ASSERT_TRUE(restored);
  EXPECT_EQ(*restored, Resumption::bias_alone);
  // A minute at 100 Hz leaves this deviation; the two scales differ by 4e-4 rad/s.
  constexpr float kSigma_rad_s = testing::kWhiteSigmaRadS / 77.0F;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(testing::bias_of(node, Predictor::kalman, axis),
                testing::bias_of(learnt, Predictor::kalman, axis) / known.model.scale.factor[axis],
                kSigma_rad_s);
  }
}

}  // namespace
}  // namespace zerorate::app

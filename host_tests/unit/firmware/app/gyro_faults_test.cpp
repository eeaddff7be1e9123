// Faults of the gyro that the loop finds in its samples.

#include <gtest/gtest.h>

#include "host_tests/unit/firmware/app/loop_rig.hpp"

namespace zerorate::app {
namespace {

using drivers::DriverErrorCode;
using testing::LoopRig;

/// A vehicle that stood for half a minute, and turns with 10 deg/s while one axis is frozen.
TEST(NodeLoopWithAFrozenAxis, PublishesNoRateUntilItMeasuresAgain) {
  LoopRig rig;
  rig.start();
  rig.samples(3000);
  rig.stuck[0] = core::rad_per_s(0.01F);
  for (int i = 0; i < 300; ++i) {
    rig.odometer.working.pulse(rig.hardware.clock.now());
    rig.sample(0.17F);
  }
  rig.published.messages.clear();
  rig.samples(1000, 0.17F);
  ASSERT_FALSE(rig.published.messages.empty());
  for (const RateMessage& message : rig.published.messages) EXPECT_FALSE(message.has_rate());
  EXPECT_EQ(rig.counters().last_error.code, DriverErrorCode::frozen);
  EXPECT_EQ(rig.counters().last_error.reg, 0b001);
  EXPECT_GT(rig.counters().starts, 3U);
  EXPECT_LT(rig.counters().starts, 20U) << "the pauses double";
  rig.stuck[0].reset();
  rig.samples(300);
  EXPECT_TRUE(rig.published.messages.back().has_rate());
}

}  // namespace
}  // namespace zerorate::app

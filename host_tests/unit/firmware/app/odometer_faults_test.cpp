// Faults of the odometer that the loop finds.

#include <gtest/gtest.h>

#include "host_tests/unit/firmware/app/loop_rig.hpp"

namespace zerorate::app {
namespace {

using core::Duration;
using testing::LoopRig;

/// A drive of five seconds and a stop, with stamps that are off by so much.
core::Motion motion_after_a_drive(LoopRig& rig, Duration offset) {
  rig.start();
  rig.samples(2000);
  for (int i = 0; i < 500; ++i) {
    rig.odometer.working.pulse(rig.hardware.clock.now() + offset);
    rig.sample(0.1F * static_cast<float>(i % 5));
    EXPECT_EQ(rig.published.messages.back().motion, core::Motion::moving);
  }
  rig.samples(1500);
  return rig.published.messages.back().motion;
}

TEST(NodeLoopWithPulsesOfTheWallClock, MovesAsTheVehicleDoes) {
  for (const std::int64_t seconds : {1'760'000'000L, 5L, -10L}) {
    LoopRig rig;
    EXPECT_EQ(motion_after_a_drive(rig, Duration::seconds(seconds)), core::Motion::still);
    EXPECT_EQ(rig.counters().foreign_stamps, 500U);
    EXPECT_FALSE(rig.published.messages.back().health.odometer_fault);
  }
}

TEST(NodeLoopWithPulsesOfItsOwnClock, TakesTheirStamps) {
  LoopRig rig;
  EXPECT_EQ(motion_after_a_drive(rig, {}), core::Motion::still);
  EXPECT_EQ(rig.counters().foreign_stamps, 0U);
}

/// The wheel sensor stands on the edge of a tooth: a pulse each so many samples.
struct Chatter {
  int every;
  float sway_rad_s;  ///< motion of the vehicle
};

int first_disagreement(const Chatter& chatter) {
  LoopRig rig;
  rig.sigma_rad_s = 5e-4F;
  rig.start();
  rig.samples(6000);
  for (int i = 0; i < 6000; ++i) {
    if (i % chatter.every == 0) rig.odometer.working.pulse(rig.hardware.clock.now());
    rig.sample(0.01F + chatter.sway_rad_s * static_cast<float>(i % 300) / 300.0F);
    if (rig.published.messages.back().health.odometer_disagreement) return i;
  }
  return 6000;
}

/// Verifies SR-HEALTH-18.
TEST(NodeLoopWithAnOdometerThatChatters, DisagreesWithinTenSeconds) {
  for (const int every : {2, 10, 104, 400}) {
    EXPECT_LT(first_disagreement({.every = every, .sway_rad_s = 0.0F}), 1100) << every;
  }
}

TEST(NodeLoopThatDrives, AgreesWithItsOdometer) {
  EXPECT_EQ(first_disagreement({.every = 10, .sway_rad_s = 2e-3F}), 6000);
}

}  // namespace
}  // namespace zerorate::app

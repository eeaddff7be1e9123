#include "core/monitor/odometer_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "host_tests/unit/core/monitor/standing_vehicle.hpp"

namespace zerorate::core {
namespace {

TEST(OdometerCheckAtALargeBias, AcceptsItsLevel) {
  Check check = make_check();
  stand(check, kBias, 100);
  EXPECT_FALSE(check.disagrees());
}

TEST(OdometerCheckAtADeparture, TrustsALevelThatNoTickWasFarFrom) {
  for (const bool is_far : {false, true}) {
    Check check = make_check();
    stand(check, kBias, 100);
    if (is_far) check.take_verdict(true);
    check.pulse({});
    EXPECT_EQ(check.state().has_trusted, !is_far);
  }
}

/// Verifies SR-HEALTH-15.
TEST(OdometerCheckWithoutPulses, NoticesATurnWithinATick) {
  Check check = make_check();
  stand(check, kBias, 120);
  EXPECT_EQ(ticks_until(check, turning(1.0F), true), 1);
  stand(check, turning(1.0F), 119);  // a minute of it
  EXPECT_TRUE(check.disagrees());
  EXPECT_EQ(ticks_until(check, kBias, false), 3);  // back for a second
}

TEST(OdometerCheckWithoutPulses, FollowsWhatChangesSlowly) {
  Check check = make_check();
  for (int tick = 0; tick < 7200; ++tick) {  // 2 deg/s within an hour
    stand(check, turning(2.0F * static_cast<float>(tick) / 7200.0F), 1);
    ASSERT_FALSE(check.disagrees()) << tick;
  }
}

/// Verifies SR-LEARN-05.
TEST(OdometerCheckWithoutPulses, AcceptsAJumpAfterTwoMinutes) {
  Check check = make_check();
  stand(check, kBias, 100);
  EXPECT_EQ(ticks_until(check, turning(0.5F), true), 1);
  EXPECT_EQ(ticks_until(check, turning(0.5F), false), 240);
  EXPECT_EQ(ticks_until(check, turning(0.5F), true), 1000);
}

TEST(OdometerCheckWhoseLevelWasNew, BelievesTheNextOneSooner) {
  Check check = make_check();
  stand(check, turning(11.0F), 1);  // the first sample meant nothing
  EXPECT_EQ(ticks_until(check, kBias, true, nullptr), 1);
  EXPECT_EQ(ticks_until(check, kBias, false, nullptr), 10);
  stand(check, kBias, 10);
  EXPECT_EQ(ticks_until(check, turning(1.0F), true, nullptr), 1);
  EXPECT_EQ(ticks_until(check, turning(1.0F), false, nullptr), 80);
}

// A car that inches round a kerb a moment after it stopped, below what its speed signal shows.
TEST(OdometerCheckInAShortStop, NeedsTwoMinutesForATurn) {
  Check check = make_check();
  check.on_driving_tick(kBias);
  stand(check, kBias, 5, &kBias);
  EXPECT_EQ(ticks_until(check, turning(4.0F), true), 1);
  EXPECT_EQ(ticks_until(check, turning(4.0F), false), 240);
}

TEST(OdometerCheckThatAcceptedATurn, ReturnsToTheLevelOfBefore) {
  Check check = make_check();
  stand(check, kBias, 100);
  EXPECT_EQ(ticks_until(check, turning(3.0F), true), 1);
  EXPECT_EQ(ticks_until(check, turning(3.0F), false), 240);
  const Rates learnt = turning(3.0F);
  EXPECT_EQ(ticks_until(check, kBias, true, &learnt), 1);
  EXPECT_EQ(ticks_until(check, kBias, false, &learnt), 2);
}

/// Verifies SR-LEARN-05.
TEST(OdometerCheckWithoutPulses, BelievesNothingThatGoesOnChanging) {
  Check check = make_check();
  stand(check, kBias, 20);
  for (int tick = 0; tick < 5000; ++tick) {
    stand(check, turning(20.0F + static_cast<float>(tick % 40)), 1);
    ASSERT_TRUE(check.turns()) << tick;
  }
}

TEST(OdometerCheckAtTheStartOfAStop, WaitsAtAFarRate) {
  Check check = make_check();
  check.on_driving_tick(kBias);
  stand(check, turning(1.3F), 1, &kBias);
  EXPECT_TRUE(check.disagrees());
  EXPECT_EQ(ticks_until(check, turning(1.3F), false), 240);  // nothing is refused for its level
  const Rates learnt = turning(1.3F);
  EXPECT_TRUE(check.disagrees());
  stand(check, learnt, 1, &learnt);
  EXPECT_FALSE(check.disagrees());
  check.on_driving_tick(learnt);
  stand(check, turning(1.5F), 1, &learnt);
  EXPECT_FALSE(check.disagrees());
  Check fresh = make_check();  // a node that has learnt nothing yet
  fresh.on_driving_tick(kBias);
  stand(fresh, turning(50.0F), 1);
  EXPECT_FALSE(fresh.disagrees());
}

// Twice five standard deviations of the prediction: 16 times five seconds.
/// Verifies SR-LEARN-07.
TEST(OdometerCheckAtTheStartOfAStop, WaitsTheLongerTheLessLikely) {
  constexpr float kSigma = 0.13F * kRadPerDeg;
  Check check = make_check();
  check.on_driving_tick(kBias);
  int ticks = 0;
  do {
    check.on_standing_tick(turning(1.3F), kSamples, &kBias, kSigma * kSigma);
    ++ticks;
  } while (check.turns() && ticks < 1000);
  EXPECT_NEAR(ticks, 161, 3);
}

/// A drive of a minute. Whether the check disagrees all the time.
bool disagrees_in_a_drive(Check& check) {
  check.pulse(Duration::seconds(20));
  bool disagrees = true;
  for (int tick = 0; tick < 120; ++tick) {
    check.on_driving_tick(turning(10.0F * static_cast<float>(tick % 7)));
    check.pulse(Duration::milliseconds(100));
    disagrees = disagrees && check.disagrees();
  }
  return disagrees;
}
Check doubting_at_departure() {
  Check check = make_check();
  stand(check, kBias, 100, &kBias);
  stand(check, turning(0.5F), 60, &kBias);
  return check;
}

/// Verifies SR-HEALTH-19.
TEST(OdometerCheckInDoubt, AgreesOnceAStopConfirmsTheBias) {
  Check check = doubting_at_departure();
  EXPECT_TRUE(disagrees_in_a_drive(check));
  stand(check, kBias, 2, &kBias);
  EXPECT_TRUE(check.disagrees());
  stand(check, kBias, 2, &kBias);
  EXPECT_FALSE(check.disagrees());
}

/// Verifies SR-LEARN-06.
TEST(OdometerCheckInDoubt, AddsUpTheStopsThatAgree) {
  Check check = doubting_at_departure();
  int stops = 0;
  do {
    EXPECT_TRUE(disagrees_in_a_drive(check));
    stand(check, turning(0.5F), 4, &kBias);  // 3 s less the settle time
    ++stops;
  } while (check.turns() && stops < 1000);
  EXPECT_NEAR(stops, 60, 2);  // 240 ticks, less 60, three a stop
  EXPECT_TRUE(check.take_jump());
  EXPECT_TRUE(disagrees_in_a_drive(check)) << "the stop was too short to learn from";
  const Rates learnt = turning(0.5F);
  stand(check, learnt, 4, &learnt);
  EXPECT_FALSE(check.disagrees());
  EXPECT_FALSE(check.take_jump());
}

TEST(OdometerCheckInDoubt, CountsAnotherLevelForItself) {
  Check check = doubting_at_departure();
  EXPECT_TRUE(disagrees_in_a_drive(check));
  stand(check, turning(1.0F), 200, &kBias);
  EXPECT_TRUE(check.turns());
  stand(check, turning(1.0F), 50, &kBias);
  EXPECT_FALSE(check.turns());
}

TEST(OdometerCheckGivenAFarLevel, DoubtsItAtDeparture) {
  Check check = make_check();
  stand(check, kBias, 100, &kBias);
  for (int tick = 0; tick < 10; ++tick) {
    stand(check, turning(0.1F), 1, &kBias);
    check.take_verdict(true);
    EXPECT_FALSE(check.disagrees());
  }
  EXPECT_TRUE(disagrees_in_a_drive(check));
}

// The wire breaks in a bend before anything has been learnt.
/// Verifies SR-LEARN-07.
TEST(OdometerCheckAtTheStartOfAStop, ComparesWithTheStopBefore) {
  Check check = make_check();
  stand(check, kBias, 4);
  check.pulse(Duration::seconds(1));
  for (int k = 0; k < 20; ++k) check.on_driving_tick(turning(13.0F));
  stand(check, turning(13.0F), 9);
  EXPECT_TRUE(check.turns());
  stand(check, turning(13.0F), 2);  // 5 s: no bend
  EXPECT_FALSE(check.turns());
}

TEST(OdometerCheckGivenAPulse, TakesTheTurnForADrive) {
  Check check = make_check();
  stand(check, kBias, 20);
  for (const float dps : {1.0F, 3.0F, 5.0F, 8.0F}) stand(check, turning(dps), 1);
  check.pulse(Duration::seconds(2));
  EXPECT_FALSE(check.disagrees());
}

/// Verifies SR-HEALTH-16.
TEST(OdometerCheckGivenPulsesAtRest, SaysSoAfterTwoMinutes) {
  Check check = make_check();
  for (int tick = 0; tick <= 240; ++tick) {
    EXPECT_FALSE(check.disagrees()) << tick;
    const float noise = 2.0F * kSigmaRadS * (tick % 2 == 0 ? 1.0F : -1.0F);
    check.on_driving_tick({kBias[0] + noise, kBias[1], kBias[2] - noise});
  }
  EXPECT_TRUE(check.disagrees());
  EXPECT_FALSE(check.turns());  // nothing keeps a stop from being learnt from
  check.on_driving_tick(turning(2.0F));
  EXPECT_FALSE(check.disagrees());
}

TEST(OdometerCheckGivenPulsesAtRest, IsSilentIfSwitchedOff) {
  Check check = make_check({.longest_straight = {}});
  for (int tick = 0; tick < 70'000; ++tick) check.on_driving_tick(kBias);
  EXPECT_FALSE(check.disagrees());
}

/// Verifies SR-HEALTH-17.
TEST(OdometerCheckGivenABounce, SaysSoForTwoSeconds) {
  Check check = make_check();
  stand(check, kBias, 3);
  check.pulse(Duration::microseconds(714));  // 14 pulses in 10 ms: 70 m/s at 5 cm a pulse
  EXPECT_FALSE(check.disagrees());
  check.pulse(Duration::microseconds(-100));  // out of order
  EXPECT_FALSE(check.disagrees());
  check.pulse(Duration::microseconds(100));
  for (int tick = 0; tick < 4; ++tick) {
    EXPECT_TRUE(check.disagrees());
    check.on_driving_tick(turning(static_cast<float>(tick)));
  }
  EXPECT_FALSE(check.disagrees());
}

TEST(OdometerCheckWithAnInfiniteTurn, NoticesNone) {
  Check check = make_check({.turn_rad_s = std::numeric_limits<float>::infinity()});
  stand(check, kBias, 20);
  stand(check, turning(200.0F), 20);
  EXPECT_FALSE(check.disagrees());
}

TEST(OdometerCheckRestored, GoesOnAsTheOtherWould) {
  Check check = make_check();
  stand(check, kBias, 20);
  stand(check, turning(1.0F), 5);
  Check other = make_check();
  other.restore(check.state());
  EXPECT_EQ(ticks_until(other, kBias, false), ticks_until(check, kBias, false));
}

}  // namespace
}  // namespace zerorate::core

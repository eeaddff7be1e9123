/// @file
/// Promises of hal/contract about MonotonicClock, PulseInput and DataReady.

#include <gtest/gtest.h>

#include <array>

#include "hal/sim/clock.hpp"
#include "hal/sim/data_ready_pin.hpp"
#include "hal/sim/odometer.hpp"

namespace zerorate::hal::sim {
namespace {

constexpr core::Instant at_ms(std::int64_t ms) {
  return core::Instant{} + core::Duration::milliseconds(ms);
}

TEST(SimulatedClock, NeverRunsBackwards) {
  SimulatedClock clock;
  clock.advance_to(at_ms(5));
  clock.advance_to(at_ms(3));
  EXPECT_EQ(clock.now(), at_ms(5));
  clock.advance(core::Duration::milliseconds(2));
  EXPECT_EQ(clock.now(), at_ms(7));
}

TEST(SimulatedClock, MayBeginBeforeTimeZero) {
  SimulatedClock clock{at_ms(-500)};
  clock.advance(core::Duration::milliseconds(100));
  EXPECT_EQ(clock.now(), at_ms(-400));
}

TEST(SimulatedOdometer, HandsOverEachPulseOnceAndInOrder) {
  SimulatedOdometer odometer;
  for (const int ms : {-2, -1, 0, 1, 2}) odometer.pulse(at_ms(ms));

  std::array<core::Instant, 3> stamps{};
  const auto first = odometer.read_pulses(stamps);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->count, 3U);
  EXPECT_EQ(stamps, (std::array{at_ms(-2), at_ms(-1), at_ms(0)}));

  const auto second = odometer.read_pulses(stamps);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->count, 2U);
  EXPECT_EQ(stamps[0], at_ms(1));
  EXPECT_EQ(stamps[1], at_ms(2));

  EXPECT_EQ(odometer.read_pulses(stamps)->count, 0U);
}

TEST(SimulatedOdometer, CountsThePulsesThatItCouldNotKeep) {
  SimulatedOdometer odometer{2};
  for (int ms = 1; ms <= 5; ++ms) odometer.pulse(at_ms(ms));
  std::array<core::Instant, 8> stamps{};
  const auto batch = odometer.read_pulses(stamps);
  EXPECT_EQ(batch->count, 2U);
  EXPECT_EQ(batch->lost, 3U);
  EXPECT_EQ(odometer.read_pulses(stamps)->lost, 0U);
}

TEST(DataReadyPin, GivesTheLatestRisingEdgeOnce) {
  DataReadyPin pin;
  EXPECT_FALSE(pin.take_edge());
  pin.drive(true, at_ms(1));
  pin.drive(true, at_ms(2));  // no edge: it was high
  pin.drive(false, at_ms(3));
  EXPECT_EQ(pin.take_edge(), at_ms(1));
  EXPECT_FALSE(pin.take_edge());
  pin.drive(true, at_ms(4));
  pin.drive(false, at_ms(5));
  pin.drive(true, at_ms(6));
  EXPECT_EQ(pin.take_edge(), at_ms(6));
}

}  // namespace
}  // namespace zerorate::hal::sim

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "core/standstill/hold_back_line.hpp"
#include "core/standstill/odometer_traits.hpp"
#include "core/standstill/standstill.hpp"

namespace zerorate::core {
namespace {

constexpr Instant at_ms(std::int64_t ms) {
  return Instant::from_ns(ms * 1'000'000);
}

constexpr Standstill::Params kParams{.settle = Duration::milliseconds(1000),
                                     .hold_back = Duration::milliseconds(500)};

/// Verifies SR-STILL-01.
TEST(StandstillAtPowerUp, WaitsForTheSettleTime) {
  Standstill standstill{kParams};
  EXPECT_FALSE(standstill.is_settled(at_ms(0)));
  standstill.start(at_ms(0));
  EXPECT_EQ(standstill.motion(at_ms(999)), Motion::moving);
  EXPECT_EQ(standstill.motion(at_ms(1000)), Motion::settling);
  EXPECT_EQ(standstill.motion(at_ms(1500)), Motion::still);
}

/// Verifies SR-STILL-01.
TEST(StandstillAfterAPulse, CountsFromThatPulse) {
  Standstill standstill{kParams};
  standstill.start(at_ms(0));
  standstill.pulse(at_ms(4900));
  standstill.pulse(at_ms(5000));
  EXPECT_EQ(standstill.motion(at_ms(5999)), Motion::moving);
  EXPECT_TRUE(standstill.is_settled(at_ms(6000)));
  EXPECT_EQ(standstill.discard_after(at_ms(5000)), at_ms(4500));
}

/// Verifies SR-STILL-02.
TEST(StandstillGivenALatePulse, KeepsTheNewest) {
  Standstill standstill{kParams};
  standstill.pulse(at_ms(5000));
  standstill.pulse(at_ms(4000));
  EXPECT_FALSE(standstill.is_settled(at_ms(5500)));
}

// The silence between two pulses of a creeping vehicle is longer than the settle time.
/// Verifies SR-STILL-03.
TEST(StandstillWhileCreeping, WaitsForTwiceTheLastSilence) {
  Standstill standstill{kParams};
  standstill.start(at_ms(0));
  for (int pulse = 1; pulse <= 10; ++pulse) {
    for (int ms = 0; ms < 3000; ms += 100) {
      EXPECT_EQ(standstill.is_settled(at_ms(3000 * (pulse - 1) + ms)), pulse == 1 && ms >= 1000);
    }
    standstill.pulse(at_ms(3000 * pulse));
  }
  EXPECT_FALSE(standstill.is_settled(at_ms(30'000 + 5'999)));
  EXPECT_TRUE(standstill.is_settled(at_ms(30'000 + 6'000)));
}

/// Each pulse of a creeping vehicle comes three times, 2 ms apart.
/// Verifies SR-STILL-04.
TEST(StandstillWithABouncingContact, WaitsAsLongAsWithoutIt) {
  for (const int bounce_ms : {1, 2, 10}) {
    Standstill standstill{kParams};
    standstill.start(at_ms(0));
    for (int pulse = 1; pulse <= 10; ++pulse) {
      const int begin = 3000 * pulse;
      for (int i = 0; i < 3; ++i) standstill.pulse(at_ms(begin + bounce_ms * i));
      for (int ms = 100; ms < 3000; ms += 100)
        EXPECT_FALSE(standstill.is_settled(at_ms(begin + ms)));
    }
  }
}

TEST(StandstillAfterAFastDrive, NeedsNoMoreThanTheSettleTime) {
  Standstill standstill{kParams};
  standstill.start(at_ms(0));
  standstill.pulse(at_ms(60'000));
  for (int ms = 0; ms < 1000; ms += 5) standstill.pulse(at_ms(60'000 + ms));
  EXPECT_TRUE(standstill.is_settled(at_ms(62'000)));
}

/// Verifies SR-STILL-03.
TEST(StandstillAfterASinglePulseOfALongStop, WaitsForCreeping) {
  Standstill standstill{kParams};
  standstill.start(at_ms(0));
  standstill.pulse(at_ms(3'600'000));
  EXPECT_FALSE(standstill.is_settled(at_ms(3'607'999)));
  EXPECT_TRUE(standstill.is_settled(at_ms(3'608'000)));
}

TEST(StandstillAfterADrive, NeedsNoMoreThanTheSettleTime) {
  Standstill standstill{kParams};
  standstill.start(at_ms(0));
  for (int ms = 0; ms <= 60'000; ms += 400) standstill.pulse(at_ms(ms));
  EXPECT_FALSE(standstill.is_settled(at_ms(60'999)));
  EXPECT_TRUE(standstill.is_settled(at_ms(61'000)));
}

struct Item {
  int number = 0;
  Instant end;
};

/// Takes every item that ends no later than `until`.
template <std::size_t Capacity>
std::vector<int> take_until(HoldBackLine<Item, Capacity>& line, Instant until) {
  line.confirm_until(until, [](Item&) {});
  std::vector<int> numbers;
  while (line.confirmed() > 0) numbers.push_back(line.take_confirmed().number);
  return numbers;
}

TEST(HoldBackLine, ConfirmsInOrderWhatIsOldEnough) {
  HoldBackLine<Item, 4> line;
  for (int i = 0; i < 4; ++i) line.push({i, at_ms(100 * i)});
  EXPECT_TRUE(line.is_full());
  EXPECT_EQ(take_until(line, at_ms(200)), (std::vector{0, 1, 2}));
  EXPECT_EQ(line.size(), 1U);
}

/// Verifies SR-LEARN-03.
TEST(HoldBackLine, DiscardsOnlyWhatMayBelongToTheDrive) {
  HoldBackLine<Item, 8> line;
  for (int i = 0; i < 8; ++i) line.push({i, at_ms(100 * i)});
  EXPECT_EQ(line.discard_after(at_ms(450)), 3U);
  EXPECT_EQ(take_until(line, at_ms(10'000)).back(), 4);
}

TEST(HoldBackLine, KeepsWhatIsConfirmed) {
  HoldBackLine<Item, 4> line;
  for (int i = 0; i < 4; ++i) line.push({i, at_ms(100 * i)});
  line.confirm_until(at_ms(100), [](Item& item) { item.number += 10; });
  EXPECT_EQ(line.discard_after(at_ms(0)), 2U);
  line.discard_newest_while([](const Item&) { return true; });
  line.discard_held();
  EXPECT_EQ(line.confirmed(), 2U);
  EXPECT_EQ(take_until(line, at_ms(0)), (std::vector{10, 11}));
}

TEST(HoldBackLine, IsEmptyAfterDiscardingWhatIsHeld) {
  HoldBackLine<Item, 4> line;
  for (int i = 0; i < 3; ++i) line.push({i, at_ms(100 * i)});
  line.discard_held();
  EXPECT_EQ(line.size(), 0U);
  line.push({7, at_ms(900)});
  EXPECT_EQ(take_until(line, at_ms(900)), std::vector{7});
  EXPECT_EQ(line.size(), 0U);
}

/// Verifies SR-MEM-06.
TEST(HoldBackLineOverflow, IsAProgrammerError) {
  HoldBackLine<Item, 1> line;
  line.push({});
  EXPECT_DEATH(line.push({}), "");
}

constexpr Standstill::Params kPlain{};

TEST(OdometerOfWhichNothingIsKnown, ChangesNothing) {
  const Standstill::Params params = adapted_to({}, kPlain);
  EXPECT_EQ(params.settle, kPlain.settle);
  EXPECT_EQ(params.hold_back, kPlain.hold_back);
  EXPECT_EQ(params.slowest, kPlain.slowest);
}

/// Verifies SR-STILL-09.
TEST(OdometerThatIsLate, HoldsBackLonger) {
  const auto params = adapted_to({.latency = Duration::milliseconds(100)}, kPlain);
  EXPECT_EQ(params.hold_back, kPlain.hold_back + Duration::milliseconds(100));
}

/// Verifies SR-STILL-09.
TEST(OdometerWithADeadBand, HoldsBackForAGentleStart) {
  const auto params = adapted_to({.dead_band_mps = 0.75F}, kPlain);
  EXPECT_EQ(params.hold_back, kPlain.hold_back + Duration::milliseconds(750));
  EXPECT_EQ(params.slowest, kPlain.slowest);
}

TEST(OdometerWithADeadBandAndAKnownPulse, NeedsTwiceTheInterval) {
  const auto params = adapted_to({.dead_band_mps = 0.5F, .metres_per_pulse = 0.25F}, kPlain);
  EXPECT_EQ(params.slowest, Duration::seconds(1));
  const auto coarse = adapted_to({.dead_band_mps = 0.5F, .metres_per_pulse = 100.0F}, kPlain);
  EXPECT_EQ(coarse.slowest, kPlain.slowest);
}

}  // namespace
}  // namespace zerorate::core

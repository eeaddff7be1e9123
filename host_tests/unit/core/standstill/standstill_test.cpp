#include "core/standstill/standstill.hpp"

#include <gtest/gtest.h>

#include "core/standstill/hold_back_line.hpp"

namespace zerorate::core {
namespace {

constexpr Instant at_ms(std::int64_t ms) {
  return Instant::from_ns(ms * 1'000'000);
}

constexpr Standstill::Params kParams{.settle = Duration::milliseconds(1000),
                                     .hold_back = Duration::milliseconds(500)};

TEST(StandstillAtPowerUp, WaitsForTheSettleTimeBeforeItBelievesInRest) {
  Standstill standstill{kParams};
  EXPECT_FALSE(standstill.is_settled(at_ms(0)));
  standstill.start(at_ms(0));
  EXPECT_EQ(standstill.motion(at_ms(999)), Motion::moving);
  EXPECT_EQ(standstill.motion(at_ms(1000)), Motion::settling);
  EXPECT_EQ(standstill.motion(at_ms(1500)), Motion::still);
}

TEST(StandstillAfterAPulse, CountsFromThatPulse) {
  Standstill standstill{kParams};
  standstill.start(at_ms(0));
  standstill.pulse(at_ms(5000));
  EXPECT_EQ(standstill.motion(at_ms(5999)), Motion::moving);
  EXPECT_TRUE(standstill.is_settled(at_ms(6000)));
  EXPECT_EQ(standstill.suspect_since(at_ms(5000)), at_ms(4500));
}

TEST(StandstillGivenALatePulse, KeepsTheNewest) {
  Standstill standstill{kParams};
  standstill.pulse(at_ms(5000));
  standstill.pulse(at_ms(4000));
  EXPECT_FALSE(standstill.is_settled(at_ms(5500)));
}

struct Item {
  int number = 0;
  Instant end;
};

TEST(HoldBackLine, ReleasesInOrderWhatIsOldEnough) {
  HoldBackLine<Item, 4> line;
  for (int i = 0; i < 4; ++i) line.push({i, at_ms(100 * i)});
  EXPECT_TRUE(line.is_full());
  int expected = 0;
  line.release_until(at_ms(200), [&](const Item& item) { EXPECT_EQ(item.number, expected++); });
  EXPECT_EQ(expected, 3);
  EXPECT_EQ(line.size(), 1U);
}

TEST(HoldBackLine, DiscardsOnlyWhatMayBelongToTheDrive) {
  HoldBackLine<Item, 8> line;
  for (int i = 0; i < 8; ++i) line.push({i, at_ms(100 * i)});
  EXPECT_EQ(line.discard_after(at_ms(450)), 3U);
  int last = -1;
  line.release_until(at_ms(10'000), [&](const Item& item) { last = item.number; });
  EXPECT_EQ(last, 4);
}

TEST(HoldBackLine, IsEmptyAfterClear) {
  HoldBackLine<Item, 4> line;
  for (int i = 0; i < 3; ++i) line.push({i, at_ms(100 * i)});
  line.clear();
  EXPECT_EQ(line.size(), 0U);
  line.push({7, at_ms(900)});
  line.release_until(at_ms(900), [](const Item& item) { EXPECT_EQ(item.number, 7); });
  EXPECT_EQ(line.size(), 0U);
}

TEST(HoldBackLineOverflow, IsAProgrammerError) {
  HoldBackLine<Item, 1> line;
  line.push({});
  EXPECT_DEATH(line.push({}), "");
}

}  // namespace
}  // namespace zerorate::core

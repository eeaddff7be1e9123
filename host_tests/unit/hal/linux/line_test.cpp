#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "hal/linux/clock.hpp"
#include "hal/linux/gpio_line.hpp"
#include "hal/linux/gpio_request.hpp"
#include "hal/sim/odometer.hpp"

namespace zerorate::hal::linux_os {
namespace {

constexpr core::Instant at_ms(std::int64_t ms) {
  return core::Instant::from_ns(ms * 1'000'000);
}

TEST(SequenceGapsOfConsecutiveNumbers, AreNone) {
  SequenceGaps gaps;
  for (std::uint32_t number = 1; number < 100; ++number) EXPECT_EQ(gaps.take(number), 0U);
}

TEST(SequenceGaps, CountTheNumbersThatAreMissing) {
  SequenceGaps gaps;
  EXPECT_EQ(gaps.take(4), 3U);  // also before the first one that was seen
  EXPECT_EQ(gaps.take(5), 0U);
  EXPECT_EQ(gaps.take(16), 10U);
}

TEST(SequenceGapsAtTheEndOfTheNumbers, GoOnFromZero) {
  SequenceGaps gaps;
  (void)gaps.take(std::numeric_limits<std::uint32_t>::max());
  EXPECT_EQ(gaps.take(0), 0U);
  EXPECT_EQ(gaps.take(2), 1U);
}

TEST(LatestEdgeOfManyEdges, IsTheNewestOnce) {
  sim::SimulatedOdometer line{100};
  LatestEdge pin{line};
  EXPECT_EQ(pin.take_edge(), std::nullopt);
  for (int ms = 0; ms < 32; ++ms) line.pulse(at_ms(ms));  // two full batches
  EXPECT_EQ(pin.take_edge(), at_ms(31));
  EXPECT_EQ(pin.take_edge(), std::nullopt);
}

TEST(LatestEdgeOfALineThatFails, IsNone) {
  struct Failing {
    core::Result<PulseBatch, BusError> read_pulses(std::span<core::Instant>) {
      return core::Unexpected{BusError::io};
    }
  } line;
  LatestEdge pin{line};
  EXPECT_EQ(pin.take_edge(), std::nullopt);
}

TEST(GpioLineOnAChipThatIsNotThere, SaysSoAtEveryRead) {
  GpioLine line{{.chip = "/dev/there-is-no-such-chip", .line = "3"}};
  std::array<core::Instant, 4> stamps{};
  for (int i = 0; i < 2; ++i) {
    const auto batch = line.read_pulses(stamps);
    ASSERT_FALSE(batch);
    EXPECT_EQ(batch.error(), BusError::not_present);
    EXPECT_EQ(line.descriptor(), -1);
  }
}

TEST(KernelClock, DoesNotRunBackwards) {
  core::Instant before = KernelClock::now();
  EXPECT_GT(before, core::Instant{});
  for (int i = 0; i < 1000; ++i) {
    const core::Instant now = KernelClock::now();
    ASSERT_GE(now, before);
    before = now;
  }
}

}  // namespace
}  // namespace zerorate::hal::linux_os

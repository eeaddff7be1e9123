/// @file
/// The chip's timer: the node's one clock, and a beat that wakes the main loop; and the watchdog on
/// the same tick, which resets the chip if the main loop stops.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/base/time.hpp"
#include "hal/contract/monotonic_clock.hpp"
#include "hal/rp2040/registers.hpp"

namespace zerorate::hal::rp2040 {

/// Microseconds since the reset (datasheet, 4.6). TIMER must be out of reset and its tick running.
class TimerClock {
 public:
  /// May be called from interrupts: the halves are read without the latching registers, which two
  /// readers would upset.
  [[nodiscard]] static std::uint64_t microseconds() {
    std::uint32_t high = timer::kRawHigh.read();
    for (;;) {
      const std::uint32_t low = timer::kRawLow.read();
      const std::uint32_t again = timer::kRawHigh.read();
      if (again == high) return (std::uint64_t{high} << 32U) | low;
      high = again;
    }
  }
  [[nodiscard]] static core::Instant now() { return instant(microseconds()); }

  [[nodiscard]] static constexpr core::Instant instant(std::uint64_t microseconds) {
    return core::Instant::from_ns(static_cast<std::int64_t>(microseconds * 1000));
  }
};
static_assert(MonotonicClock<TimerClock>);

/// The moment until which a bus may take.
class Deadline {
 public:
  explicit Deadline(std::uint32_t microseconds)
      : from_(timer::kRawLow.read()), microseconds_(microseconds) {}
  [[nodiscard]] bool is_over() const { return timer::kRawLow.read() - from_ > microseconds_; }

 private:
  std::uint32_t from_;
  std::uint32_t microseconds_;
};

/// An interrupt (timer_0) at a fixed rate, so that the main loop runs even if nothing else happens.
template <std::uint32_t PeriodMicroseconds>
class Beat {
 public:
  static void start() {
    timer::kInterruptEnable.set(bit(0));
    timer::kAlarm0.write(timer::kRawLow.read() + PeriodMicroseconds);
  }
  /// The handler of timer_0.
  void on_interrupt() {
    timer::kInterruptRaw.write(bit(0));
    timer::kAlarm0.write(timer::kRawLow.read() + PeriodMicroseconds);
    is_due_.store(true, std::memory_order_relaxed);
  }
  [[nodiscard]] bool is_due() const { return is_due_.load(std::memory_order_relaxed); }
  void take() { is_due_.store(false, std::memory_order_relaxed); }

 private:
  std::atomic<bool> is_due_{false};
};

/// Datasheet, 4.7. The counter loses two a tick (erratum RP2040-E1).
template <std::uint32_t TimeoutMicroseconds>
class Watchdog {
  static_assert(2 * TimeoutMicroseconds < (1U << 24U), "the counter has 24 bits");

 public:
  static void start() {
    feed();
    watchdog::kControl.set(watchdog::kEnable);
  }
  static void feed() { watchdog::kLoad.write(2 * TimeoutMicroseconds); }
};

}  // namespace zerorate::hal::rp2040

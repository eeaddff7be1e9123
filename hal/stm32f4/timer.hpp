/// @file
/// Timer 2: the node's one clock, and a beat that wakes the main loop.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/base/time.hpp"
#include "hal/contract/monotonic_clock.hpp"
#include "hal/cortex_m/edges.hpp"
#include "hal/stm32f4/chip.hpp"

namespace zerorate::hal::stm32f4 {

/// Microseconds since start(): 32 bits are the timer's, which overflows every 71 minutes, and 32
/// its interrupt's.
class TimerClock {
 public:
  static void start(std::uint32_t timer_hz) {
    rcc::kApb1Enable.set(rcc::kTimer2);
    timer2::kPrescaler.write(timer_hz / 1'000'000 - 1);
    timer2::kReload.write(0xFFFF'FFFF);
    timer2::kEvent.write(1);  // takes the prescaler over
    timer2::kStatus.write(0);
    timer2::kInterruptEnable.write(timer2::kOverflow);
    timer2::kControl.write(timer2::kEnable);
  }
  /// The handler of timer_2.
  static void on_interrupt() {
    if ((timer2::kStatus.read() & timer2::kOverflow) == 0) return;
    timer2::kStatus.write(~timer2::kOverflow);
    overflows.store(overflows.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  /// May be called from interrupts that timer_2 does not preempt, and with interrupts locked: an
  /// overflow that no handler has seen yet counts.
  [[nodiscard]] static std::uint64_t microseconds() {
    for (;;) {
      const std::uint32_t high = overflows.load(std::memory_order_relaxed);
      const std::uint32_t before = timer2::kCount.read();
      const bool is_pending = (timer2::kStatus.read() & timer2::kOverflow) != 0;
      const std::uint32_t low = timer2::kCount.read();
      // Neither an overflow between the readings nor a handler that took it: else once more.
      if (low < before || overflows.load(std::memory_order_relaxed) != high) continue;
      return (std::uint64_t{high + (is_pending ? 1U : 0U)} << 32U) | low;
    }
  }
  [[nodiscard]] static core::Instant now() { return instant(microseconds()); }
  [[nodiscard]] static constexpr core::Instant instant(std::uint64_t microseconds) {
    return core::Instant::from_ns(static_cast<std::int64_t>(microseconds * 1000));
  }

 private:
  // NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): written by one handler
  inline static constinit std::atomic<std::uint32_t> overflows{0};
};
static_assert(cortex_m::MicrosecondClock<TimerClock>);

/// The moment until which a bus may take.
class Deadline {
 public:
  explicit Deadline(std::uint32_t microseconds)
      : from_(timer2::kCount.read()), microseconds_(microseconds) {}
  [[nodiscard]] bool is_over() const { return timer2::kCount.read() - from_ > microseconds_; }

 private:
  std::uint32_t from_;
  std::uint32_t microseconds_;
};

/// A compare interrupt (timer_2) at a fixed rate, so that the main loop runs even if nothing else
/// happens.
template <std::uint32_t PeriodMicroseconds>
class Beat {
 public:
  /// After TimerClock::start().
  static void start() {
    timer2::kCompare1.write(timer2::kCount.read() + PeriodMicroseconds);
    timer2::kInterruptEnable.write(timer2::kOverflow | timer2::kCompare);
  }
  /// The handler of timer_2.
  void on_interrupt() {
    if ((timer2::kStatus.read() & timer2::kCompare) == 0) return;
    timer2::kStatus.write(~timer2::kCompare);
    timer2::kCompare1.write(timer2::kCount.read() + PeriodMicroseconds);
    is_due_.store(true, std::memory_order_relaxed);
  }
  [[nodiscard]] bool is_due() const { return is_due_.load(std::memory_order_relaxed); }
  void take() { is_due_.store(false, std::memory_order_relaxed); }

 private:
  std::atomic<bool> is_due_{false};
};

}  // namespace zerorate::hal::stm32f4

/// @file
/// Uses of a timer that counts microseconds: the node's one clock, time limits, and a beat that
/// wakes the main loop; and SysTick, which counts periods of the processor.
#pragma once

#include <atomic>
#include <concepts>
#include <cstdint>

#include "core/base/time.hpp"
#include "hal/contract/monotonic_clock.hpp"
#include "hal/cortex_m/registers.hpp"

namespace zerorate::hal::cortex_m {

/// A counter of microseconds since some moment, which interrupts may read too. It lasts as long as
/// the product: 32 bits of a timer are widened.
template <class Counter>
concept MicrosecondCounter = requires {
  { Counter::microseconds() } -> std::same_as<std::uint64_t>;
};

/// A timer with an alarm. `count()` is the lower half of `microseconds()`, in one load; the alarm
/// interrupts when the count reaches its value, and `take_alarm()` says in the timer's handler
/// whether it has, and forgets it.
template <class Timer>
concept AlarmTimer = MicrosecondCounter<Timer> && requires(std::uint32_t count) {
  { Timer::count() } -> std::same_as<std::uint32_t>;
  Timer::set_alarm(count);
  Timer::enable_alarm();
  { Timer::take_alarm() } -> std::same_as<bool>;
};

/// A MonotonicClock.
template <MicrosecondCounter Counter>
struct CounterClock {
  [[nodiscard]] static std::uint64_t microseconds() { return Counter::microseconds(); }
  [[nodiscard]] static core::Instant now() { return instant(microseconds()); }
  [[nodiscard]] static constexpr core::Instant instant(std::uint64_t microseconds) {
    return core::Instant::from_ns(static_cast<std::int64_t>(microseconds * 1000));
  }
};

/// The moment until which a bus may take.
template <AlarmTimer Timer>
class CounterDeadline {
 public:
  explicit CounterDeadline(std::uint32_t microseconds)
      : from_(Timer::count()), microseconds_(microseconds) {}
  [[nodiscard]] bool is_over() const { return Timer::count() - from_ > microseconds_; }

 private:
  std::uint32_t from_;
  std::uint32_t microseconds_;
};

/// An alarm at a fixed rate, so that the main loop runs even if nothing else happens.
template <AlarmTimer Timer, std::uint32_t PeriodMicroseconds>
class AlarmBeat {
 public:
  /// The timer must run.
  static void start() {
    Timer::set_alarm(Timer::count() + PeriodMicroseconds);
    Timer::enable_alarm();
  }
  /// For the timer's handler.
  void on_interrupt() {
    if (!Timer::take_alarm()) return;
    Timer::set_alarm(Timer::count() + PeriodMicroseconds);
    is_due_.store(true, std::memory_order_relaxed);
  }
  [[nodiscard]] bool is_due() const { return is_due_.load(std::memory_order_relaxed); }
  void take() { is_due_.store(false, std::memory_order_relaxed); }

 private:
  std::atomic<bool> is_due_{false};
};

/// Counts periods of the processor's clock, 24 bits. Where QEMU runs with a fixed time an
/// instruction (-icount), a difference of counts is a number of instructions.
class SysTick {
 public:
  static constexpr std::uint32_t kMask = 0x00FF'FFFF;

  static void start() {
    systick::kReload.write(kMask);
    systick::kCurrent.write(0);
    systick::kControl.write(systick::kEnable | systick::kProcessorClock);
  }
  /// Periods from an earlier count to now, up to kMask.
  [[nodiscard]] static std::uint32_t since(std::uint32_t count) {
    return (count - systick::kCurrent.read()) & kMask;  // it counts down
  }
  [[nodiscard]] static std::uint32_t count() { return systick::kCurrent.read(); }
};

}  // namespace zerorate::hal::cortex_m

/// @file
/// Timer 2, with what is made of it: the node's one clock, stamps of edges, and a beat that wakes
/// the main loop.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "hal/contract/data_ready.hpp"
#include "hal/contract/pulse_input.hpp"
#include "hal/cortex_m/edges.hpp"
#include "hal/cortex_m/timer.hpp"
#include "hal/stm32f4/registers.hpp"

namespace zerorate::hal::stm32f4 {

/// Microseconds since start(): 32 bits are the timer's, which overflows every 71 minutes, and 32
/// its interrupt's. Compare 1 is the alarm.
class Timer2 {
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
    if (!take(timer2::kOverflow)) return;
    overflows.store(overflows.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  /// May be called from interrupts that timer_2 does not preempt, and with interrupts locked: an
  /// overflow that no handler has seen yet counts.
  [[nodiscard]] static std::uint64_t microseconds() {
    for (;;) {
      const std::uint32_t high = overflows.load(std::memory_order_relaxed);
      const std::uint32_t before = count();
      const bool is_pending = (timer2::kStatus.read() & timer2::kOverflow) != 0;
      const std::uint32_t low = count();
      // Neither an overflow between the readings nor a handler that took it: else once more.
      if (low < before || overflows.load(std::memory_order_relaxed) != high) continue;
      return (std::uint64_t{high + (is_pending ? 1U : 0U)} << 32U) | low;
    }
  }
  [[nodiscard]] static std::uint32_t count() { return timer2::kCount.read(); }
  static void set_alarm(std::uint32_t count) { timer2::kCompare1.write(count); }
  static void enable_alarm() {
    timer2::kInterruptEnable.write(timer2::kOverflow | timer2::kCompare);
  }
  static bool take_alarm() { return take(timer2::kCompare); }

 private:
  static bool take(std::uint32_t event) {
    if ((timer2::kStatus.read() & event) == 0) return false;
    timer2::kStatus.write(~event);
    return true;
  }

  // NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): written by one handler
  inline static constinit std::atomic<std::uint32_t> overflows{0};
};

using TimerClock = cortex_m::CounterClock<Timer2>;
static_assert(MonotonicClock<TimerClock>);
using Deadline = cortex_m::CounterDeadline<Timer2>;
template <std::uint32_t PeriodMicroseconds>
using Beat = cortex_m::AlarmBeat<Timer2, PeriodMicroseconds>;
using LatestEdge = cortex_m::LatestEdge<Timer2>;
static_assert(DataReady<LatestEdge>);
template <std::size_t Capacity>
using EdgeQueue = cortex_m::EdgeQueue<Timer2, Capacity>;
static_assert(PulseInput<EdgeQueue<2>>);

}  // namespace zerorate::hal::stm32f4

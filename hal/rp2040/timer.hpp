/// @file
/// The chip's timer, with what is made of it: the node's one clock, stamps of edges, and a beat
/// that wakes the main loop; and the watchdog on the same tick, which resets the chip if the main
/// loop stops.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/contract/data_ready.hpp"
#include "hal/contract/pulse_input.hpp"
#include "hal/cortex_m/edges.hpp"
#include "hal/cortex_m/timer.hpp"
#include "hal/rp2040/registers.hpp"

namespace zerorate::hal::rp2040 {

/// Microseconds since the reset, with alarm 0 (datasheet, 4.6; its interrupt is timer_0). TIMER
/// must be out of reset and its tick running.
struct Timer {
  /// The halves are read without the latching registers, which two readers would upset.
  [[nodiscard]] static std::uint64_t microseconds() {
    std::uint32_t high = timer::kRawHigh.read();
    for (;;) {
      const std::uint32_t low = timer::kRawLow.read();
      const std::uint32_t again = timer::kRawHigh.read();
      if (again == high) return (std::uint64_t{high} << 32U) | low;
      high = again;
    }
  }
  [[nodiscard]] static std::uint32_t count() { return timer::kRawLow.read(); }
  static void set_alarm(std::uint32_t count) { timer::kAlarm0.write(count); }
  static void enable_alarm() { timer::kInterruptEnable.set(bit(0)); }
  /// Nothing else raises timer_0.
  static bool take_alarm() {
    timer::kInterruptRaw.write(bit(0));
    return true;
  }
};

using TimerClock = cortex_m::CounterClock<Timer>;
static_assert(MonotonicClock<TimerClock>);
using Deadline = cortex_m::CounterDeadline<Timer>;
template <std::uint32_t PeriodMicroseconds>
using Beat = cortex_m::AlarmBeat<Timer, PeriodMicroseconds>;
using LatestEdge = cortex_m::LatestEdge<Timer>;
static_assert(DataReady<LatestEdge>);
template <std::size_t Capacity>
using EdgeQueue = cortex_m::EdgeQueue<Timer, Capacity>;
static_assert(PulseInput<EdgeQueue<2>>);

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

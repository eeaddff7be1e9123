/// @file
/// Rising edges on pins, stamped in the interrupt.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/contract/data_ready.hpp"
#include "hal/contract/pulse_input.hpp"
#include "hal/cortex_m/edges.hpp"
#include "hal/stm32f4/chip.hpp"
#include "hal/stm32f4/timer.hpp"

namespace zerorate::hal::stm32f4 {

/// A pin whose rising edges interrupt by its EXTI line. No two ports can use one number.
template <unsigned Port, unsigned Number>
class EdgePin {
 public:
  static void start(Pull pull) {
    connect<Port, Number>(PinMode::input, pull);
    rcc::kApb2Enable.set(rcc::kSyscfg);
    exti::kPort<Number>.replace(15U << (4 * (Number % 4)), Port << (4 * (Number % 4)));
    exti::kRising.set(bit(Number));
    exti::kPending.write(bit(Number));  // what is old
    exti::kMask.set(bit(Number));
  }
  /// Forgets the edge that interrupted. For the handler.
  static void take_interrupt() { exti::kPending.write(bit(Number)); }
};

using LatestEdge = cortex_m::LatestEdge<TimerClock>;
static_assert(DataReady<LatestEdge>);
template <std::size_t Capacity>
using EdgeQueue = cortex_m::EdgeQueue<TimerClock, Capacity>;
static_assert(PulseInput<EdgeQueue<2>>);

}  // namespace zerorate::hal::stm32f4

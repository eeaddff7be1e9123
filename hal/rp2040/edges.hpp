/// @file
/// Rising edges on pins, stamped in the interrupt.
#pragma once

#include <cstddef>

#include "hal/contract/data_ready.hpp"
#include "hal/contract/pulse_input.hpp"
#include "hal/cortex_m/edges.hpp"
#include "hal/rp2040/chip.hpp"
#include "hal/rp2040/registers.hpp"
#include "hal/rp2040/timer.hpp"

namespace zerorate::hal::rp2040 {

/// A pin whose rising edges interrupt (io_bank0).
template <unsigned Pin>
class EdgePin {
 public:
  static void start(Pull pull) {
    connect<Pin>(io_bank0::sio, pull);
    io_bank0::kInterruptRaw<Pin>.write(io_bank0::kEdgeHigh<Pin>);  // what is old
    io_bank0::kInterruptEnable<Pin>.set(io_bank0::kEdgeHigh<Pin>);
  }
  /// Whether this pin interrupted; forgets it. For the handler.
  static bool take_interrupt() {
    if ((io_bank0::kInterruptStatus<Pin>.read() & io_bank0::kEdgeHigh<Pin>) == 0) return false;
    io_bank0::kInterruptRaw<Pin>.write(io_bank0::kEdgeHigh<Pin>);
    return true;
  }
};

using LatestEdge = cortex_m::LatestEdge<TimerClock>;
static_assert(DataReady<LatestEdge>);
template <std::size_t Capacity>
using EdgeQueue = cortex_m::EdgeQueue<TimerClock, Capacity>;
static_assert(PulseInput<EdgeQueue<2>>);

}  // namespace zerorate::hal::rp2040

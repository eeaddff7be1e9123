/// @file
/// Resets the chip if the main loop stops.
#pragma once

#include <cstdint>

#include "hal/rp2040/registers.hpp"

namespace zerorate::hal::rp2040 {

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

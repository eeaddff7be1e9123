/// @file
/// Connection of each pin. IO_BANK0 and PADS_BANK0 must be out of reset.
#pragma once

#include <cstdint>

#include "hal/rp2040/registers.hpp"

namespace zerorate::hal::rp2040 {

enum class Pull : std::uint32_t {
  none = 0,
  up = pads_bank0::kPullUp,
  down = pads_bank0::kPullDown,
};

/// Connects a pin to a peripheral (table in datasheet section 2.19.2), its input enabled.
template <unsigned Pin>
void connect(io_bank0::Function function, Pull pull = Pull::none) {
  static_assert(Pin < 30, "bank 0 has GPIO 0 to 29");
  pads_bank0::kPad<Pin>.write(pads_bank0::kInputEnable | pads_bank0::kSchmitt |
                              pads_bank0::kDrive4mA | static_cast<std::uint32_t>(pull));
  io_bank0::kControl<Pin>.write(function);
}

/// A pin that software drives; high from the start, without a pulse on the way.
template <unsigned Pin>
void connect_output_high() {
  sio::kOutSet.write(bit(Pin));
  sio::kOutEnableSet.write(bit(Pin));
  connect<Pin>(io_bank0::sio);
}

}  // namespace zerorate::hal::rp2040

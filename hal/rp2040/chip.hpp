/// @file
/// From the ring oscillator that the boot ROM leaves running to 125 MHz from the crystal, the
/// connection of each pin, and pins whose edges interrupt.
#pragma once

#include <cstdint>

#include "hal/rp2040/registers.hpp"

namespace zerorate::hal::rp2040 {

/// Frequency of clk_sys and clk_peri once start_clocks() has run; the board's crystal has 12 MHz.
inline constexpr std::uint32_t kClockHz = 125'000'000;

/// Takes blocks out of reset (resets::k...) and waits until they answer (datasheet, 2.14.1).
inline void release_from_reset(std::uint32_t blocks) {
  resets::kReset.clear(blocks);
  resets::kResetDone.await(blocks);
}

/// Crystal, system PLL, clk_sys and clk_peri at kClockHz, and the tick of 1 us that the timer and
/// the watchdog count (datasheet, 2.15.6 and 4.7.2). Call it once, first of all. About 1 ms.
inline void start_clocks() {
  constexpr std::uint32_t kCrystalMHz = 12;
  xosc::kStartup.write(47);  // 47 times 256 periods: 1 ms (2.16.3)
  xosc::kCtrl.write(xosc::kEnable1To15MHz);
  xosc::kStatus.await(xosc::kStable);
  clocks::kRefCtrl.write(clocks::kRefSourceXosc);
  clocks::kRefSelected.await(bit(clocks::kRefSourceXosc));

  // The PLL must not run clk_sys while it is set up.
  clocks::kSysCtrl.write(clocks::kSysSourceRef);
  clocks::kSysSelected.await(bit(clocks::kSysSourceRef));
  release_from_reset(resets::kPllSys);
  pll_sys::kControl.write(1);            // reference 12 MHz
  pll_sys::kFeedbackDivider.write(125);  // oscillator 1500 MHz
  pll_sys::kPowerDown.clear(pll_sys::kPowerDownMain | pll_sys::kPowerDownVco);
  pll_sys::kControl.await(pll_sys::kLocked);
  pll_sys::kPostDividers.write((6U << 16U) | (2U << 12U));  // 125 MHz
  pll_sys::kPowerDown.clear(pll_sys::kPowerDownPostDividers);
  clocks::kSysCtrl.write(clocks::kSysSourceAux);
  clocks::kSysSelected.await(bit(clocks::kSysSourceAux));
  clocks::kPeriCtrl.write(clocks::kPeriEnable);

  watchdog::kTick.write(kCrystalMHz | watchdog::kTickEnable);
}

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

/// A pin whose rising edges interrupt (io_bank0).
template <unsigned Pin>
class EdgePin {
 public:
  static void start(Pull pull) {
    connect<Pin>(io_bank0::sio, pull);
    io_bank0::kInterruptRaw<Pin>.write(io_bank0::kEdgeHigh<Pin>);  // clears older edges
    io_bank0::kInterruptEnable<Pin>.set(io_bank0::kEdgeHigh<Pin>);
  }
  /// Whether this pin interrupted; forgets it. For the handler.
  static bool take_interrupt() {
    if ((io_bank0::kInterruptStatus<Pin>.read() & io_bank0::kEdgeHigh<Pin>) == 0) return false;
    io_bank0::kInterruptRaw<Pin>.write(io_bank0::kEdgeHigh<Pin>);
    return true;
  }
};

}  // namespace zerorate::hal::rp2040

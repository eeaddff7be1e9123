/// @file
/// Clocks, pins, watchdog and the battery's RAM of an STM32F405.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/stm32f4/registers.hpp"

namespace zerorate::hal::stm32f4 {

/// Frequencies of the buses [Hz]. A timer of bus 1 counts twice as fast where the bus is divided
/// (RM0090, 7.2).
struct Clocks {
  std::uint32_t apb1_hz;
  std::uint32_t apb2_hz;
  std::uint32_t timer_hz;
};

/// 168 MHz from a crystal of 8 MHz, at 2.7 V or more. A crystal or PLL that does not start leaves
/// the chip on its internal 16 MHz, whose time is wrong by up to 1 %; the node works.
[[nodiscard]] inline Clocks start_clocks() {
  constexpr Clocks kInternal{.apb1_hz = 16'000'000, .apb2_hz = 16'000'000, .timer_hz = 16'000'000};
  const auto waited_for = [](std::uint32_t bits) {
    for (int i = 0; i < 100'000; ++i) {  // 100 ms or so; a crystal takes 2
      if ((rcc::kControl.read() & bits) != 0) return true;
    }
    return false;
  };
  rcc::kControl.set(rcc::kCrystalOn);
  if (!waited_for(rcc::kCrystalReady)) return kInternal;
  // 8 MHz / 4 * 168 / 2, and a seventh of 336 MHz for USB.
  rcc::kPll.write(4U | (168U << 6U) | rcc::kPllFromCrystal | (7U << 24U));
  rcc::kControl.set(rcc::kPllOn);
  if (!waited_for(rcc::kPllReady)) return kInternal;
  flash::kAccess.write(flash::kFiveWaitStates | flash::kPrefetchAndCaches);
  rcc::kConfiguration.write(rcc::kApb1By4 | rcc::kApb2By2 | rcc::kSwitchToPll);
  while ((rcc::kConfiguration.read() & rcc::kRunsFrom) != rcc::kRunsFromPll) {
  }
  return {.apb1_hz = 42'000'000, .apb2_hz = 84'000'000, .timer_hz = 84'000'000};
}

enum class Pull : std::uint32_t { none = 0, up = 1, down = 2 };
enum class PinMode : std::uint32_t { input = 0, output = 1, function = 2 };

/// A pin by port (A is 0) and number.
/// @param function of the data sheet's table of alternate functions, for PinMode::function
template <unsigned Port, unsigned Number>
void connect(PinMode mode, Pull pull, std::uint32_t function = 0) {
  rcc::kAhb1Enable.set(rcc::kGpioA << Port);
  gpio::kPull<Port>.replace(3U << (2 * Number), static_cast<std::uint32_t>(pull) << (2 * Number));
  gpio::kFunction<Port, Number>.replace(15U << (4 * (Number % 8)), function << (4 * (Number % 8)));
  gpio::kSpeed<Port>.replace(3U << (2 * Number), 1U << (2 * Number));
  gpio::kMode<Port>.replace(3U << (2 * Number), static_cast<std::uint32_t>(mode) << (2 * Number));
}

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

/// Resets the chip where it is not fed for two seconds.
struct Watchdog {
  static void start() {
    watchdog::kKey.write(watchdog::kStart);
    watchdog::kKey.write(watchdog::kUnlock);
    watchdog::kPrescaler.write(watchdog::kBy64);
    watchdog::kReload.write(1000);
    feed();
  }
  static void feed() { watchdog::kKey.write(watchdog::kFeed); }
};

/// The 4 KiB of RAM that a battery at VBAT keeps (RM0090, 5.1.2), as the memory of a FlashStorage:
/// no wear, no pause, and the same safety where the power goes in the middle of a save.
class BackupRam {
 public:
  static constexpr std::size_t kPageBytes = 256;
  static constexpr std::size_t kSectorBytes = 2048;

  static void start() {
    rcc::kApb1Enable.set(rcc::kPower);
    power::kControl.set(power::kBackupWritable);
    rcc::kAhb1Enable.set(rcc::kBackupRam);
    power::kStatus.set(power::kBackupRegulator);
  }
  static void erase_sector(std::uint32_t offset) {
    std::ranges::fill(bytes(offset, kSectorBytes), std::uint8_t{0xFF});
  }
  static void program(std::uint32_t offset, std::span<const std::uint8_t> from) {
    std::ranges::copy(from, bytes(offset, from.size()).begin());
  }
  [[nodiscard]] static std::span<const std::uint8_t> view(std::uint32_t offset, std::size_t size) {
    return bytes(offset, size);
  }

 private:
  static std::span<std::uint8_t> bytes(std::uint32_t offset, std::size_t size) {
    // The address is the hardware's.
    // NOLINTNEXTLINE(performance-no-int-to-ptr,cppcoreguidelines-pro-type-reinterpret-cast)
    return {reinterpret_cast<std::uint8_t*>(std::uintptr_t{0x4002'4000} + offset), size};
  }
};

}  // namespace zerorate::hal::stm32f4

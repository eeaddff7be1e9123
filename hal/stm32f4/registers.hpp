/// @file
/// The registers and bits of the STM32F405 that the project uses. Sections are those of its
/// reference manual (RM0090, STMicroelectronics), where the names come from too.
#pragma once

#include <cstdint>

#include "hal/cortex_m/registers.hpp"

namespace zerorate::hal::stm32f4 {

using cortex_m::bit;

/// One 32-bit register. set(), clear() and replace() read first: an interrupt that changes the same
/// register between would be undone, so they are for the start.
template <std::uint32_t Address>
struct Register : cortex_m::Register<Address> {
  using cortex_m::Register<Address>::read;
  using cortex_m::Register<Address>::write;
  static void set(std::uint32_t bits) { write(read() | bits); }
  static void clear(std::uint32_t bits) { write(read() & ~bits); }
  /// Writes a value into the bits of a mask.
  static void replace(std::uint32_t mask, std::uint32_t value) { write((read() & ~mask) | value); }
};

/// 7.3: clocks and which blocks have one.
namespace rcc {
inline constexpr Register<0x4002'3800> kControl;
inline constexpr Register<0x4002'3804> kPll;
inline constexpr Register<0x4002'3808> kConfiguration;
inline constexpr Register<0x4002'3830> kAhb1Enable;
inline constexpr Register<0x4002'3840> kApb1Enable;
inline constexpr Register<0x4002'3844> kApb2Enable;
inline constexpr std::uint32_t kCrystalOn = bit(16);
inline constexpr std::uint32_t kCrystalReady = bit(17);
inline constexpr std::uint32_t kPllOn = bit(24);
inline constexpr std::uint32_t kPllReady = bit(25);
inline constexpr std::uint32_t kPllFromCrystal = bit(22);
inline constexpr std::uint32_t kSwitchToPll = 2;
inline constexpr std::uint32_t kRunsFromPll = 2U << 2U;
inline constexpr std::uint32_t kRunsFrom = 3U << 2U;
inline constexpr std::uint32_t kApb1By4 = 5U << 10U;
inline constexpr std::uint32_t kApb2By2 = 4U << 13U;
inline constexpr std::uint32_t kGpioA = bit(0);  // B is the next
inline constexpr std::uint32_t kBackupRam = bit(18);
inline constexpr std::uint32_t kTimer2 = bit(0);
inline constexpr std::uint32_t kUsart2 = bit(17);
inline constexpr std::uint32_t kPower = bit(28);
inline constexpr std::uint32_t kSpi1 = bit(12);
inline constexpr std::uint32_t kSyscfg = bit(14);
}  // namespace rcc

/// 3.9.1: wait states of the flash, its prefetch and caches.
namespace flash {
inline constexpr Register<0x4002'3C00> kAccess;
inline constexpr std::uint32_t kFiveWaitStates = 5;
inline constexpr std::uint32_t kPrefetchAndCaches = bit(8) | bit(9) | bit(10);
}  // namespace flash

/// 5.4: the domain that a battery keeps.
namespace power {
inline constexpr Register<0x4000'7000> kControl;
inline constexpr Register<0x4000'7004> kStatus;
inline constexpr std::uint32_t kBackupWritable = bit(8);
inline constexpr std::uint32_t kBackupRegulator = bit(9);
}  // namespace power

/// 8.4: pins. Ports A, B, ... are 0, 1, ...
namespace gpio {
template <unsigned Port>
inline constexpr std::uint32_t kBase = 0x4002'0000 + 0x400 * Port;
template <unsigned Port>
inline constexpr Register<kBase<Port>> kMode;
template <unsigned Port>
inline constexpr Register<kBase<Port> + 0x08> kSpeed;
template <unsigned Port>
inline constexpr Register<kBase<Port> + 0x0C> kPull;
template <unsigned Port>
inline constexpr Register<kBase<Port> + 0x18> kSetReset;
template <unsigned Port, unsigned Pin>
inline constexpr Register<kBase<Port> + 0x20 + 4 * (Pin / 8)> kFunction;
}  // namespace gpio

/// 9.2.3 and 12.3: interrupts of pins. Line n is pin n of one of the ports.
namespace exti {
template <unsigned Pin>
inline constexpr Register<0x4001'3808 + 4 * (Pin / 4)> kPort;
inline constexpr Register<0x4001'3C00> kMask;
inline constexpr Register<0x4001'3C08> kRising;
inline constexpr Register<0x4001'3C14> kPending;  // a one clears
}  // namespace exti

/// 18.4: timer 2, 32 bits.
namespace timer2 {
inline constexpr Register<0x4000'0000> kControl;
inline constexpr Register<0x4000'000C> kInterruptEnable;
inline constexpr Register<0x4000'0010> kStatus;  // a zero clears
inline constexpr Register<0x4000'0014> kEvent;
inline constexpr Register<0x4000'0024> kCount;
inline constexpr Register<0x4000'0028> kPrescaler;
inline constexpr Register<0x4000'002C> kReload;
inline constexpr Register<0x4000'0034> kCompare1;
inline constexpr std::uint32_t kEnable = bit(0);
inline constexpr std::uint32_t kOverflow = bit(0);
inline constexpr std::uint32_t kCompare = bit(1);
}  // namespace timer2

/// 28.5: SPI 1.
namespace spi1 {
inline constexpr Register<0x4001'3000> kControl1;
inline constexpr Register<0x4001'3008> kStatus;
inline constexpr Register<0x4001'300C> kData;
inline constexpr std::uint32_t kSecondEdge = bit(0);
inline constexpr std::uint32_t kIdlesHigh = bit(1);
inline constexpr std::uint32_t kController = bit(2);
inline constexpr std::uint32_t kEnable = bit(6);
inline constexpr std::uint32_t kSelectedBySoftware = bit(8) | bit(9);
inline constexpr std::uint32_t kReceived = bit(0);
inline constexpr std::uint32_t kTransmitEmpty = bit(1);
inline constexpr std::uint32_t kBusy = bit(7);
}  // namespace spi1

/// 30.6: USART 2.
namespace usart2 {
inline constexpr Register<0x4000'4400> kStatus;
inline constexpr Register<0x4000'4404> kData;
inline constexpr Register<0x4000'4408> kBaud;
inline constexpr Register<0x4000'440C> kControl;
inline constexpr std::uint32_t kReceived = bit(5);
inline constexpr std::uint32_t kTransmitEmpty = bit(7);
inline constexpr std::uint32_t kTransmitInterrupt = bit(7);
inline constexpr std::uint32_t kEnableBothWays = bit(13) | bit(3) | bit(2);
}  // namespace usart2

/// 21.4: the independent watchdog, on a clock of its own of about 32 kHz.
namespace watchdog {
inline constexpr Register<0x4000'3000> kKey;
inline constexpr Register<0x4000'3004> kPrescaler;
inline constexpr Register<0x4000'3008> kReload;
inline constexpr std::uint32_t kFeed = 0xAAAA;
inline constexpr std::uint32_t kUnlock = 0x5555;
inline constexpr std::uint32_t kStart = 0xCCCC;
inline constexpr std::uint32_t kBy64 = 4;
}  // namespace watchdog

/// 12.1 (table 61): numbers of interrupts.
namespace nvic {
enum Interrupt : unsigned { exti0 = 6, exti1 = 7, timer_2 = 28, usart_2 = 38 };
}  // namespace nvic

}  // namespace zerorate::hal::stm32f4

/// @file
/// The registers and bits of the RP2040 that the project uses. Sections are those of the RP2040
/// datasheet (Raspberry Pi Ltd), where the names come from too.
#pragma once

#include <cstdint>

#include "hal/cortex_m/registers.hpp"

namespace zerorate::hal::rp2040 {

using cortex_m::Access;
using cortex_m::bit;

/// One 32-bit register of the RP2040. The registers of the APB and AHB peripherals have atomic
/// aliases that set or clear the bits written as ones and leave the others alone, which an
/// interrupt cannot tear (RP2040 datasheet, section 2.1.2).
template <std::uint32_t Address, Access Kind = Access::read_write>
class Register : public cortex_m::Register<Address, Kind> {
 public:
  static constexpr bool kHasAliases = Address >= 0x4000'0000 && Address < 0x6000'0000;

  static void set(std::uint32_t bits) requires(Kind != Access::read_only && kHasAliases) {
    cortex_m::WriteOnly<Address + 0x2000>::write(bits);
  }
  static void clear(std::uint32_t bits) requires(Kind != Access::read_only && kHasAliases) {
    cortex_m::WriteOnly<Address + 0x3000>::write(bits);
  }
};

template <std::uint32_t Address>
using ReadOnly = Register<Address, Access::read_only>;
template <std::uint32_t Address>
using WriteOnly = Register<Address, Access::write_only>;

/// 2.14.3: subsystem resets. A block in reset ignores its bus.
namespace resets {
inline constexpr Register<0x4000'C000> kReset;
inline constexpr ReadOnly<0x4000'C008> kResetDone;
inline constexpr std::uint32_t kI2c0 = bit(3);
inline constexpr std::uint32_t kIoBank0 = bit(5);
inline constexpr std::uint32_t kPadsBank0 = bit(8);
inline constexpr std::uint32_t kPllSys = bit(12);
inline constexpr std::uint32_t kSpi0 = bit(16);
inline constexpr std::uint32_t kTimer = bit(21);
inline constexpr std::uint32_t kUart0 = bit(22);
}  // namespace resets

/// 2.15.7: clock generators. SELECTED is one-hot: bit i is set while source i runs the clock.
namespace clocks {
inline constexpr Register<0x4000'8030> kRefCtrl;
inline constexpr ReadOnly<0x4000'8038> kRefSelected;
inline constexpr Register<0x4000'803C> kSysCtrl;
inline constexpr ReadOnly<0x4000'8044> kSysSelected;
inline constexpr Register<0x4000'8048> kPeriCtrl;
inline constexpr std::uint32_t kRefSourceXosc = 2;
inline constexpr std::uint32_t kSysSourceRef = 0;
inline constexpr std::uint32_t kSysSourceAux = 1;      // with AUXSRC = 0: the system PLL
inline constexpr std::uint32_t kPeriEnable = bit(11);  // with AUXSRC = 0: clk_sys
}  // namespace clocks

/// 2.16.7: crystal oscillator.
namespace xosc {
inline constexpr Register<0x4002'4000> kCtrl;
inline constexpr ReadOnly<0x4002'4004> kStatus;
inline constexpr Register<0x4002'400C> kStartup;
inline constexpr std::uint32_t kEnable1To15MHz = (0xFABU << 12U) | 0xAA0U;
inline constexpr std::uint32_t kStable = bit(31);
}  // namespace xosc

/// 2.18.4: system PLL.
namespace pll_sys {
inline constexpr Register<0x4002'8000> kControl;
inline constexpr Register<0x4002'8004> kPowerDown;
inline constexpr Register<0x4002'8008> kFeedbackDivider;
inline constexpr Register<0x4002'800C> kPostDividers;
inline constexpr std::uint32_t kLocked = bit(31);
inline constexpr std::uint32_t kPowerDownMain = bit(0);
inline constexpr std::uint32_t kPowerDownPostDividers = bit(3);
inline constexpr std::uint32_t kPowerDownVco = bit(5);
}  // namespace pll_sys

/// 2.19.6.1: function and interrupts of the pins of bank 0.
namespace io_bank0 {
template <unsigned Pin>
inline constexpr Register<0x4001'4004 + 8 * Pin> kControl;
enum Function : std::uint32_t { spi = 1, uart = 2, i2c = 3, sio = 5 };
/// Four bits a pin, eight pins a register.
template <unsigned Pin>
inline constexpr Register<0x4001'40F0 + 4 * (Pin / 8)> kInterruptRaw;  // write one to clear
template <unsigned Pin>
inline constexpr Register<0x4001'4100 + 4 * (Pin / 8)> kInterruptEnable;
template <unsigned Pin>
inline constexpr ReadOnly<0x4001'4120 + 4 * (Pin / 8)> kInterruptStatus;
template <unsigned Pin>
inline constexpr std::uint32_t kEdgeHigh = bit(3 + 4 * (Pin % 8));
}  // namespace io_bank0

/// 2.19.6.3: electrical properties of the pins of bank 0.
namespace pads_bank0 {
template <unsigned Pin>
inline constexpr Register<0x4001'C004 + 4 * Pin> kPad;
inline constexpr std::uint32_t kSchmitt = bit(1);
inline constexpr std::uint32_t kPullDown = bit(2);
inline constexpr std::uint32_t kPullUp = bit(3);
inline constexpr std::uint32_t kDrive4mA = 1U << 4U;
inline constexpr std::uint32_t kInputEnable = bit(6);
}  // namespace pads_bank0

/// 2.3.1.7: single-cycle I/O.
namespace sio {
inline constexpr ReadOnly<0xD000'0004> kIn;
inline constexpr WriteOnly<0xD000'0014> kOutSet;
inline constexpr WriteOnly<0xD000'0018> kOutClear;
inline constexpr WriteOnly<0xD000'0024> kOutEnableSet;
inline constexpr WriteOnly<0xD000'0028> kOutEnableClear;
}  // namespace sio

/// 4.6.5: the timer, 64 bits of microseconds.
namespace timer {
inline constexpr Register<0x4005'4010> kAlarm0;
inline constexpr ReadOnly<0x4005'4024> kRawHigh;
inline constexpr ReadOnly<0x4005'4028> kRawLow;
inline constexpr Register<0x4005'4034> kInterruptRaw;  // write one to clear
inline constexpr Register<0x4005'4038> kInterruptEnable;
}  // namespace timer

/// 4.7.6: watchdog, and the tick that it makes for the timer.
namespace watchdog {
inline constexpr Register<0x4005'8000> kControl;
inline constexpr WriteOnly<0x4005'8004> kLoad;
inline constexpr Register<0x4005'802C> kTick;
inline constexpr std::uint32_t kEnable = bit(30);
inline constexpr std::uint32_t kTickEnable = bit(9);
}  // namespace watchdog

/// 4.2.8: UART 0 (Arm PL011).
namespace uart0 {
inline constexpr Register<0x4003'4000> kData;
inline constexpr ReadOnly<0x4003'4018> kFlags;
inline constexpr Register<0x4003'4024> kBaudInteger;
inline constexpr Register<0x4003'4028> kBaudFraction;
inline constexpr Register<0x4003'402C> kLineControl;
inline constexpr Register<0x4003'4030> kControl;
inline constexpr Register<0x4003'4038> kInterruptMask;
inline constexpr WriteOnly<0x4003'4044> kInterruptClear;
inline constexpr std::uint32_t kReceiveEmpty = bit(4);
inline constexpr std::uint32_t kTransmitFull = bit(5);
inline constexpr std::uint32_t kFifosEnabled8Bits = bit(4) | (3U << 5U);
inline constexpr std::uint32_t kEnableBothWays = bit(0) | bit(8) | bit(9);
inline constexpr std::uint32_t kTransmitInterrupt = bit(5);
}  // namespace uart0

/// 4.4.4: SPI 0 (Arm PL022).
namespace spi0 {
inline constexpr Register<0x4003'C000> kControl0;
inline constexpr Register<0x4003'C004> kControl1;
inline constexpr Register<0x4003'C008> kData;
inline constexpr ReadOnly<0x4003'C00C> kStatus;
inline constexpr Register<0x4003'C010> kPrescale;
inline constexpr std::uint32_t kFrames8Bits = 7;
inline constexpr std::uint32_t kClockIdlesHigh = bit(6);      // SPO
inline constexpr std::uint32_t kSampleOnSecondEdge = bit(7);  // SPH
inline constexpr std::uint32_t kEnable = bit(1);              // SSE
inline constexpr std::uint32_t kTransmitNotFull = bit(1);
inline constexpr std::uint32_t kReceiveNotEmpty = bit(2);
inline constexpr std::uint32_t kBusy = bit(4);
}  // namespace spi0

/// 4.3.17: I2C 0 (Synopsys DW_apb_i2c).
namespace i2c0 {
inline constexpr Register<0x4004'4000> kControl;
inline constexpr Register<0x4004'4004> kTarget;
inline constexpr Register<0x4004'4010> kDataCommand;
inline constexpr Register<0x4004'401C> kFastHighCount;
inline constexpr Register<0x4004'4020> kFastLowCount;
inline constexpr ReadOnly<0x4004'4034> kInterruptRaw;
inline constexpr ReadOnly<0x4004'4054> kClearAbort;
inline constexpr ReadOnly<0x4004'4060> kClearStop;
inline constexpr Register<0x4004'406C> kEnable;
inline constexpr ReadOnly<0x4004'4070> kStatus;
inline constexpr ReadOnly<0x4004'4080> kAbortSource;
inline constexpr Register<0x4004'407C> kDataHold;
inline constexpr Register<0x4004'40A0> kSpikeLength;
inline constexpr std::uint32_t kControllerMode = bit(0) | bit(6);  // and not a target
inline constexpr std::uint32_t kFastMode = 2U << 1U;
inline constexpr std::uint32_t kRestartEnabled = bit(5);
inline constexpr std::uint32_t kTxEmptyWhenSent = bit(8);
inline constexpr std::uint32_t kRead = bit(8);
inline constexpr std::uint32_t kStop = bit(9);
inline constexpr std::uint32_t kRestart = bit(10);
inline constexpr std::uint32_t kAborted = bit(6);
inline constexpr std::uint32_t kStopDetected = bit(9);
inline constexpr std::uint32_t kTransmitNotFull = bit(1);
inline constexpr std::uint32_t kReceiveNotEmpty = bit(3);
inline constexpr std::uint32_t kAbortLostArbitration = bit(12);
}  // namespace i2c0

/// 4.10.13: the serial interface to the flash (Synopsys DW_apb_ssi), which maps it to memory.
namespace ssi {
inline constexpr Register<0x1800'0000> kControl0;
inline constexpr Register<0x1800'0008> kEnable;
inline constexpr Register<0x1800'0010> kSelect;
inline constexpr ReadOnly<0x1800'0028> kStatus;
inline constexpr Register<0x1800'0060> kData;
inline constexpr std::uint32_t kFrames8Bits = 7U << 16U;         // sent and received at once
inline constexpr std::uint32_t kMapped = (31U << 16U) | 0x300U;  // mode that boot2.S leaves
inline constexpr std::uint32_t kBusy = bit(0);
inline constexpr std::uint32_t kReceiveNotEmpty = bit(3);
}  // namespace ssi

/// 2.19.6.2: the pins of the flash.
namespace io_qspi {
inline constexpr Register<0x4001'800C> kChipSelect;
inline constexpr std::uint32_t kOverrideNone = 0;
inline constexpr std::uint32_t kOverrideLow = 2U << 8U;
inline constexpr std::uint32_t kOverrideHigh = 3U << 8U;
}  // namespace io_qspi

/// 2.3.2: numbers of interrupts.
namespace nvic {
enum Interrupt : unsigned { timer_0 = 0, io_bank0 = 13, uart0 = 20 };
}  // namespace nvic

}  // namespace zerorate::hal::rp2040

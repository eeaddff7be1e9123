/// @file
/// The registers and bits of the ICM-45686 that the driver uses. Names are TDK's; README.md gives
/// the source of each fact.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::drivers::icm45686 {

/// 7-bit address by the level of pin AP_AD0.
inline constexpr hal::I2cAddress kAddressAd0Low{0x68};
inline constexpr hal::I2cAddress kAddressAd0High{0x69};

inline constexpr Register<0x00, Access::read_only> kAccelDataX;  // gyro, temperature, time follow
inline constexpr Register<0x0C, Access::read_only> kTempData;    // up to FIFO_COUNT_1
inline constexpr Register<0x10, Access::read_write> kPwrMgmt0;
inline constexpr Register<0x12, Access::read_only> kFifoCount0;
inline constexpr Register<0x14, Access::read_only> kFifoData;
inline constexpr Register<0x16, Access::read_write, 0x80> kInt1Config0;
inline constexpr Register<0x18, Access::read_write, 0x04> kInt1Config2;
inline constexpr Register<0x19, Access::read_only> kInt1Status0;  // up to FIFO_CONFIG2
inline constexpr Register<0x1B, Access::read_write, 0x06> kAccelConfig0;
inline constexpr Register<0x1C, Access::read_write, 0x06> kGyroConfig0;
inline constexpr Register<0x1D, Access::read_write> kFifoConfig0;
inline constexpr Register<0x1E, Access::read_write> kFifoConfig1Low;
inline constexpr Register<0x1F, Access::read_write> kFifoConfig1High;
inline constexpr Register<0x20, Access::read_write, 0x20> kFifoConfig2;
inline constexpr Register<0x21, Access::read_write> kFifoConfig3;
inline constexpr Register<0x22, Access::read_write> kFifoConfig4;
inline constexpr Register<0x32, Access::read_write> kDriveConfig0;
inline constexpr Register<0x72, Access::read_only, 0xE9> kWhoAmI;
inline constexpr Register<0x7C, Access::read_write> kIregAddr;
inline constexpr Register<0x7E, Access::read_write> kIregData;
inline constexpr Register<0x7F, Access::read_write, 0x01> kRegMisc2;

/// Bit 7 of an address: a register that is reached through IREG_ADDR and IREG_DATA.
inline constexpr std::uint8_t kIndirect = 0x80;
inline constexpr Register<0x80, Access::read_write> kSregCtrl;
inline constexpr Register<0x81, Access::read_write, 0x80> kGyroUiLpf;
inline constexpr Register<0x82, Access::read_write> kAccelUiLpf;
inline constexpr Register<0x83, Access::read_write> kSmcControl0;

/// Addresses behind them: SREG_CTRL, IPREG_SYS1_REG_172, IPREG_SYS2_REG_131, SMC_CONTROL_0.
inline constexpr std::array<std::uint16_t, 4> kIregAddresses{0xA267, 0xA4AC, 0xA583, 0xA258};

/// Bits and fields, named register_field.
namespace bits {
inline constexpr std::uint8_t kPwrMgmt0Modes = 0x0F;
inline constexpr std::uint8_t kPwrMgmt0GyroLowNoise = 0x0C;
inline constexpr std::uint8_t kPwrMgmt0AccelLowNoise = 0x03;
inline constexpr std::uint8_t kInt1Drdy = 0x04;
inline constexpr std::uint8_t kInt1FifoThs = 0x02;
inline constexpr std::uint8_t kInt1FifoFull = 0x01;
inline constexpr std::uint8_t kInt1Config2All = 0x07;
inline constexpr std::uint8_t kInt1Config2ActiveHigh = 0x01;  // push-pull and pulsed: 0
inline constexpr std::uint8_t kAccelConfig0All = 0x7F;
inline constexpr std::uint8_t kFifoModeStopOnFull = 0x80;
inline constexpr std::uint8_t kFifoDepth2k = 0x07;
inline constexpr std::uint8_t kFifoConfig2Flush = 0x80;
inline constexpr std::uint8_t kFifoConfig2WmGtTh = 0x08;
inline constexpr std::uint8_t kFifoConfig3All = 0x3F;
inline constexpr std::uint8_t kFifoConfig3GyroEn = 0x04;
inline constexpr std::uint8_t kFifoConfig3AccelEn = 0x02;
inline constexpr std::uint8_t kFifoConfig3IfEn = 0x01;
inline constexpr std::uint8_t kFifoConfig4Content = 0x07;
inline constexpr std::uint8_t kFifoConfig4TmstEn = 0x02;
inline constexpr std::uint8_t kDriveConfig0SpiSlew = 0x0E;
inline constexpr std::uint8_t kDriveConfig0SpiSlew10ns = 0x04;
inline constexpr std::uint8_t kRegMisc2SoftReset = 0x02;
inline constexpr std::uint8_t kRegMisc2IregDone = 0x01;
inline constexpr std::uint8_t kSregCtrlBigEndian = 0x02;
inline constexpr std::uint8_t kUiLpf = 0x07;
inline constexpr std::uint8_t kUiLpfQuarter = 0x01;
inline constexpr std::uint8_t kSmcControl0TmstEn = 0x01;
inline constexpr std::uint8_t kSmcControl0TempDis = 0x08;
}  // namespace bits

/// Size at the depth that is chosen.
inline constexpr unsigned kFifoBytes = 2048;
/// Size of the whole memory: no level is above it.
inline constexpr unsigned kMostFifoBytes = 8192;

}  // namespace zerorate::drivers::icm45686

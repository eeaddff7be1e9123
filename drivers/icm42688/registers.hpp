/// @file
/// The registers and bits of the ICM-42688-P that the driver uses, all of bank 0; TDK DS-000347,
/// chapters 13 and 14. Names are TDK's.
#pragma once

#include <cstdint>

#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::drivers::icm42688 {

/// 7-bit address by the level of pin AP_AD0.
inline constexpr hal::I2cAddress kAddressAd0Low{0x68};
inline constexpr hal::I2cAddress kAddressAd0High{0x69};

inline constexpr Register<0x11, Access::read_write> kDeviceConfig;
inline constexpr Register<0x14, Access::read_write> kIntConfig;
inline constexpr Register<0x16, Access::read_write> kFifoConfig;
inline constexpr Register<0x1D, Access::read_only> kTempData1;  // accelerometer, gyro follow
inline constexpr Register<0x2D, Access::read_only> kIntStatus;  // FIFO_COUNTH, FIFO_COUNTL follow
inline constexpr Register<0x30, Access::read_only> kFifoData;
inline constexpr Register<0x4C, Access::read_write, 0x30> kIntfConfig0;
inline constexpr Register<0x4D, Access::read_write, 0x91> kIntfConfig1;
inline constexpr Register<0x4E, Access::read_write> kPwrMgmt0;
inline constexpr Register<0x4F, Access::read_write, 0x06> kGyroConfig0;
inline constexpr Register<0x50, Access::read_write, 0x06> kAccelConfig0;
inline constexpr Register<0x52, Access::read_write, 0x11> kGyroAccelConfig0;
inline constexpr Register<0x5F, Access::read_write> kFifoConfig1;
inline constexpr Register<0x60, Access::read_write> kFifoConfig2;
inline constexpr Register<0x61, Access::read_write> kFifoConfig3;
inline constexpr Register<0x64, Access::read_write, 0x10> kIntConfig1;
inline constexpr Register<0x65, Access::read_write, 0x10> kIntSource0;
inline constexpr Register<0x75, Access::read_only, 0x47> kWhoAmI;  // REG_BANK_SEL follows
inline constexpr Register<0x76, Access::read_write> kRegBankSel;   // shared by all banks

/// Bits and fields, named register_field.
namespace bits {
inline constexpr std::uint8_t kDeviceConfigSoftReset = 0x01;
inline constexpr std::uint8_t kIntConfigInt1 = 0x07;
inline constexpr std::uint8_t kIntConfigInt1PushPull = 0x02;
inline constexpr std::uint8_t kIntConfigInt1ActiveHigh = 0x01;
inline constexpr std::uint8_t kFifoConfigMode = 0xC0;
inline constexpr std::uint8_t kFifoModeStream = 0x40;
inline constexpr std::uint8_t kIntStatusAlwaysZero = 0x80;
inline constexpr std::uint8_t kIntStatusDataRdy = 0x08;
inline constexpr std::uint8_t kIntStatusFifoFull = 0x02;
inline constexpr std::uint8_t kIntfConfig0Data = 0xF0;
inline constexpr std::uint8_t kIntfConfig0FifoCountBigEndian = 0x20;
inline constexpr std::uint8_t kIntfConfig0SensorDataBigEndian = 0x10;
inline constexpr std::uint8_t kIntfConfig1Afsr = 0xC0;
inline constexpr std::uint8_t kIntfConfig1AfsrOff = 0x40;
inline constexpr std::uint8_t kPwrMgmt0All = 0x3F;
inline constexpr std::uint8_t kPwrMgmt0GyroLowNoise = 0x0C;
inline constexpr std::uint8_t kPwrMgmt0AccelLowNoise = 0x03;
inline constexpr std::uint8_t kGyroConfig0All = 0xEF;
inline constexpr std::uint8_t kAccelConfig0All = 0xEF;
inline constexpr std::uint8_t kGyroUiFiltBw = 0x0F;
inline constexpr std::uint8_t kAccelUiFiltBw = 0xF0;
inline constexpr std::uint8_t kFifoConfig1All = 0x7F;
inline constexpr std::uint8_t kFifoConfig1WmGtTh = 0x20;
inline constexpr std::uint8_t kFifoConfig1TempEn = 0x04;
inline constexpr std::uint8_t kFifoConfig1GyroEn = 0x02;
inline constexpr std::uint8_t kFifoConfig1AccelEn = 0x01;
inline constexpr std::uint8_t kFifoConfig3Wm = 0x0F;
inline constexpr std::uint8_t kIntConfig1AsyncReset = 0x10;
inline constexpr std::uint8_t kIntSource0All = 0x7F;
inline constexpr std::uint8_t kIntSource0UiDrdy = 0x08;
inline constexpr std::uint8_t kIntSource0FifoThs = 0x04;
inline constexpr std::uint8_t kRegBankSelBank = 0x07;
}  // namespace bits

inline constexpr unsigned kFifoBytes = 2048;

}  // namespace zerorate::drivers::icm42688

/// @file
/// The registers and bits of the MPU-6500 and its relatives that the driver uses; InvenSense
/// RM-MPU-6500A-00 and RM-MPU-6000A-00. Names are InvenSense's.
#pragma once

#include <cstdint>

#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::drivers::mpu6500 {

/// 7-bit address by the level of pin AD0.
inline constexpr hal::I2cAddress kAddressAd0Low{0x68};
inline constexpr hal::I2cAddress kAddressAd0High{0x69};

inline constexpr Register<0x19, Access::read_write> kSmplrtDiv;
inline constexpr Register<0x1A, Access::read_write> kConfig;
inline constexpr Register<0x1B, Access::read_write> kGyroConfig;
inline constexpr Register<0x1C, Access::read_write> kAccelConfig;
inline constexpr Register<0x1D, Access::read_write> kAccelConfig2;  // not of an MPU-6050
inline constexpr Register<0x23, Access::read_write> kFifoEn;
inline constexpr Register<0x37, Access::read_write> kIntPinCfg;
inline constexpr Register<0x38, Access::read_write> kIntEnable;
// Accelerometer, temperature and gyro follow.
inline constexpr Register<0x3A, Access::read_only> kIntStatus;
inline constexpr Register<0x68, Access::write_only> kSignalPathReset;
inline constexpr Register<0x6A, Access::read_write> kUserCtrl;
inline constexpr Register<0x6B, Access::read_write, 0x01> kPwrMgmt1;  // 40h in an MPU-6050
inline constexpr Register<0x6C, Access::read_write> kPwrMgmt2;
inline constexpr Register<0x70, Access::read_write> kI2cIf;      // I2C_IF_DIS; ICM-20602, MPU-6886
inline constexpr Register<0x72, Access::read_only> kFifoCountH;  // FIFO_COUNTL follows
inline constexpr Register<0x74, Access::read_only> kFifoRW;      // a burst stays here
inline constexpr Register<0x75, Access::read_only, 0x70> kWhoAmI;

/// Bits and fields, named register_field.
namespace bits {
// FIFO_MODE, of the MPU-6500 alone, FSYNC and the low-pass filter; bit 7 of an ICM-20602 is 1 after
// reset and has to be cleared.
inline constexpr std::uint8_t kConfigAll = 0xFF;
// Self-test, range, and FCHOICE_B, of the MPU-6500 alone, which would go round the filter.
inline constexpr std::uint8_t kGyroConfigAll = 0xFB;
// Self-test, range; an MPU-6050 has its high-pass filter in bits 2:0.
inline constexpr std::uint8_t kAccelConfigAll = 0xFF;
inline constexpr std::uint8_t kAccelConfig2Filter = 0x0F;  // FCHOICE_B, low-pass filter
inline constexpr std::uint8_t kFifoEnGyro = 0x70;
inline constexpr std::uint8_t kFifoEnAccel = 0x08;
inline constexpr std::uint8_t kFifoEnGyroAndTemperature = 0x10;  // ICM-20602 and MPU-6886
// Active low, open drain, latched, cleared by any reading, FSYNC, bypass.
inline constexpr std::uint8_t kIntPinCfgAll = 0xFE;
inline constexpr std::uint8_t kIntEnableAll = 0x79;
inline constexpr std::uint8_t kIntFifoOflow = 0x10;
inline constexpr std::uint8_t kIntDataRdy = 0x01;
// Free fall, zero motion and PLL ready of some of the chips: never at once, since the thresholds
// of the first two are 0.
inline constexpr std::uint8_t kIntStatusNeverAtOnce = 0xA4;
inline constexpr std::uint8_t kSignalPathResetAll = 0x07;
inline constexpr std::uint8_t kUserCtrlAll = 0xF0;
inline constexpr std::uint8_t kUserCtrlFifoEn = 0x40;
inline constexpr std::uint8_t kUserCtrlI2cIfDis = 0x10;
inline constexpr std::uint8_t kUserCtrlFifoReset = 0x04;
inline constexpr std::uint8_t kI2cIfDis = 0x40;
inline constexpr std::uint8_t kPwrMgmt1DeviceReset = 0x80;
inline constexpr std::uint8_t kPwrMgmt1Pll = 0x01;  // awake, clock of the gyro
inline constexpr std::uint8_t kPwrMgmt2Standby = 0x3F;
inline constexpr std::uint8_t kPwrMgmt2AccelOff = 0x38;
}  // namespace bits

/// x, y and z of the gyro, without a mark.
inline constexpr unsigned kFifoSampleBytes = 6;
/// x, y and z of the accelerometer in front of them.
inline constexpr unsigned kLongSampleBytes = 12;
/// The temperature, in front of the gyro, where the chip puts it into the FIFO.
inline constexpr unsigned kTemperatureBytes = 2;

}  // namespace zerorate::drivers::mpu6500

/// @file
/// The registers and bits of the ICM-20948 that the driver uses; InvenSense DS-000189, 7 to 10.
/// Names are InvenSense's. The registers lie in banks: bit 7 of an address here stands for bank 2,
/// and bank 0 has no such bit (banked_registers.hpp).
#pragma once

#include <cstdint>

#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::drivers::icm20948 {

/// 7-bit address by the level of pin AD0.
inline constexpr hal::I2cAddress kAddressAd0Low{0x68};
inline constexpr hal::I2cAddress kAddressAd0High{0x69};

inline constexpr Register<0x00, Access::read_only, 0xEA> kWhoAmI;
inline constexpr Register<0x03, Access::read_write> kUserCtrl;
inline constexpr Register<0x05, Access::read_write, 0x40> kLpConfig;
inline constexpr Register<0x06, Access::read_write, 0x41> kPwrMgmt1;
inline constexpr Register<0x07, Access::read_write> kPwrMgmt2;
inline constexpr Register<0x0F, Access::read_write> kIntPinCfg;
inline constexpr Register<0x10, Access::read_write> kIntEnable;
inline constexpr Register<0x11, Access::read_write> kIntEnable1;
inline constexpr Register<0x12, Access::read_write> kIntEnable2;
inline constexpr Register<0x13, Access::read_write> kIntEnable3;
// Three more of the kind follow, then accelerometer, gyro and temperature from 2Dh to 3Ah.
inline constexpr Register<0x19, Access::read_only> kIntStatus;
inline constexpr Register<0x66, Access::read_write> kFifoEn1;
inline constexpr Register<0x67, Access::read_write> kFifoEn2;
inline constexpr Register<0x68, Access::read_write> kFifoRst;
inline constexpr Register<0x69, Access::read_write> kFifoMode;
inline constexpr Register<0x70, Access::read_only> kFifoCountH;  // FIFO_COUNTL follows
inline constexpr Register<0x72, Access::read_only> kFifoRW;      // a burst stays here
inline constexpr Register<0x7F, Access::read_write> kRegBankSel;

inline constexpr std::uint8_t kBank2 = 0x80;
inline constexpr Register<kBank2 | 0x00, Access::read_write> kGyroSmplrtDiv;
inline constexpr Register<kBank2 | 0x01, Access::read_write, 0x01> kGyroConfig1;
inline constexpr Register<kBank2 | 0x02, Access::read_write> kGyroConfig2;
inline constexpr Register<kBank2 | 0x09, Access::read_write> kOdrAlignEn;
inline constexpr Register<kBank2 | 0x10, Access::read_write> kAccelSmplrtDiv1;
inline constexpr Register<kBank2 | 0x11, Access::read_write> kAccelSmplrtDiv2;
inline constexpr Register<kBank2 | 0x14, Access::read_write, 0x01> kAccelConfig;

/// Bits and fields, named register_field.
namespace bits {
inline constexpr std::uint8_t kUserCtrlAll = 0xF0;
inline constexpr std::uint8_t kUserCtrlFifoEn = 0x40;
inline constexpr std::uint8_t kUserCtrlI2cIfDis = 0x10;
inline constexpr std::uint8_t kLpConfigCycles = 0x30;
inline constexpr std::uint8_t kPwrMgmt1DeviceReset = 0x80;
inline constexpr std::uint8_t kPwrMgmt1AutoClock = 0x01;  // awake
inline constexpr std::uint8_t kPwrMgmt2Standby = 0x3F;
inline constexpr std::uint8_t kPwrMgmt2AccelOff = 0x38;
// Active low, open drain, latched, cleared by any reading, FSYNC, bypass.
inline constexpr std::uint8_t kIntPinCfgAll = 0xFE;
inline constexpr std::uint8_t kIntEnableAll = 0x8F;
inline constexpr std::uint8_t kRawDataRdy = 0x01;  // bit of INT_ENABLE_1 and INT_STATUS_1
inline constexpr std::uint8_t kFifos = 0x1F;       // a bit for each of five
inline constexpr std::uint8_t kIntStatus1Reserved = 0xFE;
inline constexpr std::uint8_t kFifoEn1All = 0x0F;
inline constexpr std::uint8_t kFifoEn2Gyro = 0x0E;
inline constexpr std::uint8_t kFifoEn2Accel = 0x10;
inline constexpr std::uint8_t kRegBankSelBank = 0x30;
inline constexpr std::uint8_t kRegBankSelBank2 = 0x20;
// Filter, range, filter on.
inline constexpr std::uint8_t kGyroConfig1All = 0x3F;
inline constexpr std::uint8_t kGyroConfig2SelfTest = 0x38;
inline constexpr std::uint8_t kOdrAlignEn = 0x01;
inline constexpr std::uint8_t kAccelSmplrtDiv1All = 0x0F;
inline constexpr std::uint8_t kAccelConfigAll = 0x3F;
inline constexpr std::uint8_t kFchoice = 0x01;  // filter on, in GYRO_CONFIG_1 and ACCEL_CONFIG
}  // namespace bits

/// x, y and z of the gyro, without a mark; those of the accelerometer in front of them.
inline constexpr unsigned kFifoSampleBytes = 6;
inline constexpr unsigned kLongSampleBytes = 12;

}  // namespace zerorate::drivers::icm20948

/// @file
/// The registers and bits of the BMI160 that the driver uses; Bosch BST-BMI160-DS000, 2.11. Names
/// are Bosch's.
#pragma once

#include <cstdint>

#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::drivers::bmi160 {

/// 7-bit address by the level of pin SDO.
inline constexpr hal::I2cAddress kAddressSdoLow{0x68};
inline constexpr hal::I2cAddress kAddressSdoHigh{0x69};

inline constexpr Register<0x00, Access::read_only, 0xD1> kChipId;
inline constexpr Register<0x03, Access::read_only> kPmuStatus;
// Accelerometer, sensor time, status, interrupts, temperature and level of the FIFO follow.
inline constexpr Register<0x0C, Access::read_only> kGyrData;
inline constexpr Register<0x1B, Access::read_only> kStatus;
inline constexpr Register<0x24, Access::read_only> kFifoData;  // a burst stays here
inline constexpr Register<0x40, Access::read_write, 0x28> kAccConf;
inline constexpr Register<0x41, Access::read_write, 0x03> kAccRange;
inline constexpr Register<0x42, Access::read_write, 0x28> kGyrConf;
inline constexpr Register<0x43, Access::read_write> kGyrRange;
inline constexpr Register<0x45, Access::read_write, 0x88> kFifoDowns;
inline constexpr Register<0x46, Access::read_write, 0x80> kFifoConfig0;
inline constexpr Register<0x47, Access::read_write, 0x10> kFifoConfig1;
inline constexpr Register<0x51, Access::read_write> kIntEn1;
inline constexpr Register<0x53, Access::read_write> kIntOutCtrl;
inline constexpr Register<0x54, Access::read_write> kIntLatch;
inline constexpr Register<0x56, Access::read_write> kIntMap1;
inline constexpr Register<0x7E, Access::write_only> kCmd;
/// Reading it switches the chip to SPI.
inline constexpr Register<0x7F, Access::read_only> kSpiCommTest;

/// Bits and fields, named register_field.
namespace bits {
inline constexpr std::uint8_t kPmuStatusBoth = 0x3C;
inline constexpr std::uint8_t kPmuStatusGyrNormal = 0x04;
inline constexpr std::uint8_t kPmuStatusAccNormal = 0x10;
inline constexpr std::uint8_t kStatusDrdyAcc = 0x80;
inline constexpr std::uint8_t kStatusDrdyGyr = 0x40;
inline constexpr std::uint8_t kStatusNvmRdy = 0x10;
inline constexpr std::uint8_t kStatusAlwaysZero = 0x04;  // no magnetometer is asked
inline constexpr std::uint8_t kAccConfAll = 0xFF;        // undersampling, bandwidth, rate
inline constexpr std::uint8_t kAccRangeAll = 0x0F;
inline constexpr std::uint8_t kGyrConfAll = 0x3F;
inline constexpr std::uint8_t kGyrRangeAll = 0x07;
inline constexpr std::uint8_t kBandwidthNormal = 0x20;
inline constexpr std::uint8_t kFifoDownsNone = 0x88;  // filtered data, each of them
inline constexpr std::uint8_t kFifoConfig1All = 0xFE;
inline constexpr std::uint8_t kFifoConfig1Gyr = 0x80;
inline constexpr std::uint8_t kFifoConfig1Acc = 0x40;
inline constexpr std::uint8_t kIntEn1All = 0x7F;
inline constexpr std::uint8_t kIntEn1Drdy = 0x10;
inline constexpr std::uint8_t kIntEn1Watermark = 0x40;
inline constexpr std::uint8_t kIntOutCtrlInt1 = 0x0F;
inline constexpr std::uint8_t kIntOutCtrlActiveHigh = 0x0A;  // output, push-pull, level
inline constexpr std::uint8_t kIntLatchInt1 = 0x1F;
inline constexpr std::uint8_t kIntMap1Int1 = 0xF0;
inline constexpr std::uint8_t kIntMap1Drdy = 0x80;
inline constexpr std::uint8_t kIntMap1Watermark = 0x40;
}  // namespace bits

/// Commands.
inline constexpr std::uint8_t kCmdAccNormal = 0x11;
inline constexpr std::uint8_t kCmdGyrNormal = 0x15;
inline constexpr std::uint8_t kCmdFifoFlush = 0xB0;
inline constexpr std::uint8_t kCmdSoftReset = 0xB6;

inline constexpr unsigned kFifoBytes = 1024;
/// x, y and z of the gyro, without a header; those of the accelerometer behind them.
inline constexpr unsigned kFifoFrameBytes = 6;
inline constexpr unsigned kLongFrameBytes = 12;

}  // namespace zerorate::drivers::bmi160

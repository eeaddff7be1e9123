/// @file
/// The registers and bits of the BMI088's gyro that the driver uses; Bosch BST-BMI088-DS001, 5.4
/// and 5.5. Those of its accelerometer, 5.2 and 5.3, begin with Acc. Names are Bosch's.
#pragma once

#include <cstdint>

#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::drivers::bmi088 {

/// 7-bit address of the gyro by the level of pin SDO2. The accelerometer has an address, and on SPI
/// a chip select, of its own.
inline constexpr hal::I2cAddress kAddressSdo2Low{0x68};
inline constexpr hal::I2cAddress kAddressSdo2High{0x69};

/// 7-bit address of the accelerometer by the level of pin SDO1.
inline constexpr hal::I2cAddress kAccAddressSdo1Low{0x18};
inline constexpr hal::I2cAddress kAccAddressSdo1High{0x19};

inline constexpr Register<0x00, Access::read_only, 0x0F> kGyroChipId;
inline constexpr Register<0x0E, Access::read_only> kFifoStatus;
inline constexpr Register<0x0F, Access::read_write> kGyroRange;
inline constexpr Register<0x10, Access::read_write, 0x80> kGyroBandwidth;
inline constexpr Register<0x11, Access::read_write> kGyroLpm1;
inline constexpr Register<0x14, Access::write_only> kGyroSoftreset;
inline constexpr Register<0x15, Access::read_write> kGyroIntCtrl;
inline constexpr Register<0x16, Access::read_write, 0x0F> kInt3Int4IoConf;
inline constexpr Register<0x18, Access::read_write> kInt3Int4IoMap;
inline constexpr Register<0x1E, Access::read_write, 0x08> kFifoWmEnable;
inline constexpr Register<0x3D, Access::read_write> kFifoConfig0;
inline constexpr Register<0x3E, Access::read_write> kFifoConfig1;
inline constexpr Register<0x3F, Access::read_only> kFifoData;

inline constexpr Register<0x00, Access::read_only, 0x1E> kAccChipId;
inline constexpr Register<0x24, Access::read_only> kAccFifoLength0;  // FIFO_LENGTH_1 follows
inline constexpr Register<0x26, Access::read_only> kAccFifoData;
inline constexpr Register<0x40, Access::read_write, 0xA8> kAccConf;
inline constexpr Register<0x41, Access::read_write, 0x01> kAccRange;
inline constexpr Register<0x48, Access::read_write, 0x02> kAccFifoConfig0;
inline constexpr Register<0x49, Access::read_write, 0x10> kAccFifoConfig1;
inline constexpr Register<0x7C, Access::read_write, 0x03> kAccPwrConf;
inline constexpr Register<0x7D, Access::read_write> kAccPwrCtrl;
inline constexpr Register<0x7E, Access::write_only> kAccSoftreset;

/// Bits and fields, named register_field.
namespace bits {
inline constexpr std::uint8_t kFifoStatusOverrun = 0x80;
inline constexpr std::uint8_t kFifoStatusFrames = 0x7F;
inline constexpr std::uint8_t kGyroRangeRange = 0x07;
inline constexpr std::uint8_t kGyroBandwidthBw = 0x0F;
inline constexpr std::uint8_t kGyroLpm1Suspend = 0xA0;  // suspend and deep suspend
inline constexpr std::uint8_t kSoftresetCommand = 0xB6;
inline constexpr std::uint8_t kIntCtrlBoth = 0xC0;
inline constexpr std::uint8_t kIntCtrlDataEn = 0x80;
inline constexpr std::uint8_t kIntCtrlFifoEn = 0x40;
inline constexpr std::uint8_t kIoConfInt3 = 0x03;
inline constexpr std::uint8_t kIoConfInt3ActiveHigh = 0x01;  // and push-pull
inline constexpr std::uint8_t kIoMapAll = 0xA5;
inline constexpr std::uint8_t kIoMapInt3Data = 0x01;
inline constexpr std::uint8_t kIoMapInt3Fifo = 0x04;
inline constexpr std::uint8_t kFifoWmEnableBoth = 0x88;
inline constexpr std::uint8_t kFifoWmOn = 0x88;
inline constexpr std::uint8_t kFifoWmOff = 0x08;
inline constexpr std::uint8_t kFifoConfig1Mode = 0xC0;
inline constexpr std::uint8_t kFifoModeStopOnFull = 0x40;
inline constexpr std::uint8_t kAccConfNormalFilter = 0xA0;
inline constexpr std::uint8_t kAccRangeRange = 0x03;
inline constexpr std::uint8_t kAccFifoConfig0Mode = 0x01;  // 0: stream
inline constexpr std::uint8_t kAccFifoConfig1Sources = 0x4C;
inline constexpr std::uint8_t kAccFifoConfig1AccEn = 0x40;  // not the interrupts' levels
inline constexpr std::uint8_t kAccPwrConfActive = 0x00;
inline constexpr std::uint8_t kAccPwrCtrlOn = 0x04;
inline constexpr std::uint8_t kAccSoftresetCommand = 0xB6;
inline constexpr std::uint8_t kAccFifoFlushCommand = 0xB0;
}  // namespace bits

/// A frame is three words without a header.
inline constexpr unsigned kFifoFrameBytes = 6;
inline constexpr unsigned kFifoFrames = 100;
/// A frame of the accelerometer is a header and three words.
inline constexpr unsigned kAccFifoFrameBytes = 7;
inline constexpr unsigned kAccFifoBytes = 1024;

}  // namespace zerorate::drivers::bmi088

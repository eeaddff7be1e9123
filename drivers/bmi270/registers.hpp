/// @file
/// The registers and bits of the BMI270 that the driver uses; Bosch BST-BMI270-DS000. Names are
/// Bosch's.
#pragma once

#include <cstdint>

#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::drivers::bmi270 {

/// 7-bit address by the level of pin SDO.
inline constexpr hal::I2cAddress kAddressSdoLow{0x68};
inline constexpr hal::I2cAddress kAddressSdoHigh{0x69};

inline constexpr Register<0x00, Access::read_only, 0x24> kChipId;
// Magnetometer, accelerometer from 0Ch, gyro from 12h, sensor time and interrupts follow.
inline constexpr Register<0x03, Access::read_only> kStatus;
// Temperature and level of the FIFO follow.
inline constexpr Register<0x21, Access::read_only> kInternalStatus;
inline constexpr Register<0x26, Access::read_only> kFifoData;  // a burst stays here
// On the page of FEAT_PAGE (2Fh) after a reset.
inline constexpr Register<0x3C, Access::read_only> kGyrCas;
inline constexpr Register<0x40, Access::read_write, 0xA8> kAccConf;
inline constexpr Register<0x41, Access::read_write, 0x02> kAccRange;
inline constexpr Register<0x42, Access::read_write, 0xA9> kGyrConf;
inline constexpr Register<0x43, Access::read_write> kGyrRange;
inline constexpr Register<0x45, Access::read_write, 0x88> kFifoDowns;
inline constexpr Register<0x46, Access::read_write> kFifoWtm0;
inline constexpr Register<0x47, Access::read_write, 0x02> kFifoWtm1;
inline constexpr Register<0x48, Access::read_write, 0x02> kFifoConfig0;
inline constexpr Register<0x49, Access::read_write, 0x10> kFifoConfig1;
inline constexpr Register<0x53, Access::read_write> kInt1IoCtrl;
inline constexpr Register<0x55, Access::read_write> kIntLatch;
inline constexpr Register<0x58, Access::read_write> kIntMapData;
inline constexpr Register<0x59, Access::read_write> kInitCtrl;
inline constexpr Register<0x5B, Access::read_write> kInitAddr0;
inline constexpr Register<0x5C, Access::read_write> kInitAddr1;
inline constexpr Register<0x5E, Access::read_write> kInitData;  // a burst stays here
inline constexpr Register<0x7C, Access::read_write, 0x03> kPwrConf;
inline constexpr Register<0x7D, Access::read_write> kPwrCtrl;
inline constexpr Register<0x7E, Access::write_only> kCmd;

/// Bits and fields, named register_field.
namespace bits {
inline constexpr std::uint8_t kStatusDrdyAcc = 0x80;
inline constexpr std::uint8_t kStatusDrdyGyr = 0x40;
inline constexpr std::uint8_t kInternalStatusMessage = 0x0F;
inline constexpr std::uint8_t kInternalStatusInitOk = 0x01;
inline constexpr std::uint8_t kAccConfAll = 0xFF;
inline constexpr std::uint8_t kAccRangeAll = 0x03;
inline constexpr std::uint8_t kGyrConfAll = 0xFF;
inline constexpr std::uint8_t kGyrRangeAll = 0x0F;  // with the range of the second interface
// Best filter, filter below half the rate; of the gyro also the lowest noise.
inline constexpr std::uint8_t kAccConfNormal = 0xA0;
inline constexpr std::uint8_t kGyrConfNormal = 0xE0;
inline constexpr std::uint8_t kFifoDownsNone = 0x88;  // filtered data, each of them
inline constexpr std::uint8_t kFifoWtm1All = 0x1F;
inline constexpr std::uint8_t kFifoConfig0All = 0x03;  // stops when full, sensor time
inline constexpr std::uint8_t kFifoConfig1All = 0xF0;
inline constexpr std::uint8_t kFifoConfig1Gyr = 0x80;
inline constexpr std::uint8_t kFifoConfig1Acc = 0x40;
inline constexpr std::uint8_t kInt1IoCtrlAll = 0x1E;
inline constexpr std::uint8_t kInt1IoCtrlActiveHigh = 0x0A;  // output, push-pull
inline constexpr std::uint8_t kIntLatchAll = 0x01;
inline constexpr std::uint8_t kIntMapDataInt1 = 0x0F;
inline constexpr std::uint8_t kIntMapDataDrdy = 0x04;
inline constexpr std::uint8_t kIntMapDataWatermark = 0x02;
inline constexpr std::uint8_t kPwrConfAll = 0x07;
inline constexpr std::uint8_t kPwrConfAwake = 0x02;  // no power save; FIFO wakes by itself
inline constexpr std::uint8_t kPwrCtrlAll = 0x0F;
inline constexpr std::uint8_t kPwrCtrlGyr = 0x02;
inline constexpr std::uint8_t kPwrCtrlAcc = 0x04;
inline constexpr std::uint8_t kPwrCtrlTemp = 0x08;
}  // namespace bits

/// Commands.
inline constexpr std::uint8_t kCmdFifoFlush = 0xB0;
inline constexpr std::uint8_t kCmdSoftReset = 0xB6;

/// The longer one is that of Bosch's file without features.
inline constexpr unsigned kFifoBytes = 2048;
inline constexpr unsigned kLongestFifoBytes = 6144;
/// x, y and z of the gyro, without a header; those of the accelerometer behind them.
inline constexpr unsigned kFifoFrameBytes = 6;
inline constexpr unsigned kLongFrameBytes = 12;

}  // namespace zerorate::drivers::bmi270

/// @file
/// The registers and bits of the LSM6DSO that the driver uses; ST DS12140, chapters 8 and 9.
/// Names are ST's. The ISM330DHCX and the ASM330LHH have the same; what differs in the LSM6DSV16X
/// is named Dsv (lsm6dsv16x-pid).
#pragma once

#include <cstdint>

#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::drivers::lsm6dso {

/// 7-bit address by the level of pin SDO/SA0 (DS12140, I2C interface).
inline constexpr hal::I2cAddress kAddressSa0Low{0x6A};
inline constexpr hal::I2cAddress kAddressSa0High{0x6B};

inline constexpr Register<0x07, Access::read_write> kFifoCtrl1;
inline constexpr Register<0x08, Access::read_write> kFifoCtrl2;
inline constexpr Register<0x09, Access::read_write> kFifoCtrl3;
inline constexpr Register<0x0A, Access::read_write> kFifoCtrl4;
inline constexpr Register<0x0D, Access::read_write> kInt1Ctrl;
inline constexpr Register<0x0F, Access::read_only, 0x6C> kWhoAmI;
inline constexpr Register<0x10, Access::read_write> kCtrl1Xl;
inline constexpr Register<0x11, Access::read_write> kCtrl2G;
inline constexpr Register<0x12, Access::read_write, 0x04> kCtrl3C;
inline constexpr Register<0x13, Access::read_write> kCtrl4C;
inline constexpr Register<0x15, Access::read_write> kCtrl6C;
inline constexpr Register<0x16, Access::read_write> kCtrl7G;
inline constexpr Register<0x17, Access::read_write> kCtrl8Xl;
inline constexpr Register<0x18, Access::read_write, 0xE0> kCtrl9Xl;
inline constexpr Register<0x1E, Access::read_only> kStatusReg;
inline constexpr Register<0x20, Access::read_only> kOutTempL;  // 6 bytes of rate follow at 0x22,
                                                               // 6 of acceleration at 0x28
inline constexpr Register<0x3A, Access::read_only> kFifoStatus1;
inline constexpr Register<0x63, Access::read_only> kInternalFreqFine;
inline constexpr Register<0x78, Access::read_only> kFifoDataOutTag;  // 6 bytes of data follow

inline constexpr Register<0x10, Access::read_write> kDsvCtrl1;
inline constexpr Register<0x11, Access::read_write> kDsvCtrl2;
inline constexpr Register<0x13, Access::read_write> kDsvCtrl4;
inline constexpr Register<0x15, Access::read_write> kDsvCtrl6;
inline constexpr Register<0x16, Access::read_write> kDsvCtrl7;
inline constexpr Register<0x17, Access::read_write> kDsvCtrl8;
inline constexpr Register<0x18, Access::read_write> kDsvCtrl9;
inline constexpr Register<0x1B, Access::read_only> kDsvFifoStatus1;
inline constexpr Register<0x4F, Access::read_only> kDsvInternalFreq;

/// Bits and fields, named register_field.
namespace bits {
inline constexpr std::uint8_t kFifoCtrl2StopOnWtm = 0x80;
inline constexpr std::uint8_t kFifoCtrl2FifoComprRtEn = 0x40;
inline constexpr std::uint8_t kFifoCtrl2OdrChgEn = 0x10;
inline constexpr std::uint8_t kFifoCtrl2Wtm8 = 0x01;
inline constexpr std::uint8_t kFifoCtrl3BdrGy = 0xF0;
inline constexpr std::uint8_t kFifoCtrl3BdrXl = 0x0F;
inline constexpr std::uint8_t kFifoCtrl4DecTsBatch = 0xC0;
inline constexpr std::uint8_t kFifoCtrl4OdrTBatch = 0x30;
inline constexpr std::uint8_t kFifoCtrl4FifoMode = 0x07;
inline constexpr std::uint8_t kFifoModeContinuous = 0x06;
inline constexpr std::uint8_t kInt1FifoTh = 0x08;
inline constexpr std::uint8_t kInt1DrdyG = 0x02;
inline constexpr std::uint8_t kCtrl1XlOdrXl = 0xF0;
inline constexpr std::uint8_t kCtrl1XlAll = 0xFE;  // rate, range, LPF2
inline constexpr std::uint8_t kCtrl2GAll = 0xFF;
inline constexpr std::uint8_t kCtrl3CBdu = 0x40;
inline constexpr std::uint8_t kCtrl3CIfInc = 0x04;
inline constexpr std::uint8_t kCtrl3CSwReset = 0x01;
inline constexpr std::uint8_t kCtrl4CSleepG = 0x40;
inline constexpr std::uint8_t kCtrl4CLpf1SelG = 0x02;
inline constexpr std::uint8_t kCtrl6CXlHmMode = 0x10;
inline constexpr std::uint8_t kCtrl7GGHmMode = 0x80;
inline constexpr std::uint8_t kCtrl7GHpEnG = 0x40;
inline constexpr std::uint8_t kCtrl8XlOff = 0x06;  // high-pass filter, other meaning of FS_XL
inline constexpr std::uint8_t kCtrl9XlI3cDisable = 0x02;
inline constexpr std::uint8_t kStatusXlda = 0x01;
inline constexpr std::uint8_t kStatusGda = 0x02;
inline constexpr std::uint8_t kFifoStatus2OvrLatched = 0x08;
inline constexpr std::uint8_t kDsvCtrl1OdrXl = 0x0F;
inline constexpr std::uint8_t kDsvCtrl1All = 0x7F;   // mode and rate
inline constexpr std::uint8_t kDsvCtrl2All = 0x7F;   // mode and rate
inline constexpr std::uint8_t kDsvCtrl4Drdy = 0x0A;  // pulsed, masked
inline constexpr std::uint8_t kDsvCtrl6All = 0x7F;   // bandwidth of LPF1, range
inline constexpr std::uint8_t kDsvCtrl7Off = 0x81;   // Qvar, LPF1
inline constexpr std::uint8_t kDsvCtrl8All = 0x0B;   // dual channel, range
inline constexpr std::uint8_t kDsvCtrl9Off = 0x18;   // high-pass filter, LPF2
}  // namespace bits

/// Data words of the FIFO: one tag byte, then six bytes (DS12140, section 6.5.7).
inline constexpr unsigned kFifoWordBytes = 7;
inline constexpr std::uint8_t kTagGyro = 0x01;
inline constexpr std::uint8_t kTagAccelerometer = 0x02;

}  // namespace zerorate::drivers::lsm6dso

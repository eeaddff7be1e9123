/// @file
/// The registers and bits of the L3GD20H and its relatives that the driver uses; ST DocID023469,
/// chapter 7. Names are ST's.
#pragma once

#include <cstdint>

#include "drivers/common/register_access.hpp"
#include "hal/contract/i2c_bus.hpp"

namespace zerorate::drivers::l3gd20h {

/// 7-bit address by the level of pin SDO/SA0.
inline constexpr hal::I2cAddress kAddressSa0Low{0x6A};
inline constexpr hal::I2cAddress kAddressSa0High{0x6B};
/// Addresses of the L3G4200D.
inline constexpr hal::I2cAddress kOldAddressSa0Low{0x68};
inline constexpr hal::I2cAddress kOldAddressSa0High{0x69};

inline constexpr Register<0x0F, Access::read_only, 0xD7> kWhoAmI;
inline constexpr Register<0x20, Access::read_write, 0x07> kCtrl1;
inline constexpr Register<0x21, Access::read_write> kCtrl2;
inline constexpr Register<0x22, Access::read_write> kCtrl3;
inline constexpr Register<0x23, Access::read_write> kCtrl4;
inline constexpr Register<0x24, Access::read_write> kCtrl5;
inline constexpr Register<0x27, Access::read_only> kStatus;  // x, y and z follow
inline constexpr Register<0x2E, Access::read_write> kFifoCtrl;
inline constexpr Register<0x2F, Access::read_only> kFifoSrc;
inline constexpr Register<0x39, Access::read_write> kLowOdr;  // L3GD20H

/// Registers at which bursts begin: a bit of the address asks for the increment, bit 6 over SPI and
/// bit 7 over I2C. From the FIFO a burst goes on at OUT_X_L after OUT_Z_H.
template <bool kIsSpi>
inline constexpr std::uint8_t kIncrement = kIsSpi ? 0x40 : 0x80;
template <bool kIsSpi>
inline constexpr Register<0x27 | kIncrement<kIsSpi>, Access::read_only> kStatusAndOutputs{};
template <bool kIsSpi>
inline constexpr Register<0x28 | kIncrement<kIsSpi>, Access::read_only> kOutputs{};

/// Bits and fields, named register_field.
namespace bits {
inline constexpr std::uint8_t kCtrl1On = 0x0F;  // PD, and the three axes
inline constexpr std::uint8_t kCtrl3DataReady = 0x08;
inline constexpr std::uint8_t kCtrl3Watermark = 0x04;
inline constexpr std::uint8_t kCtrl4Bdu = 0x80;
inline constexpr std::uint8_t kCtrl5Boot = 0x80;
inline constexpr std::uint8_t kCtrl5FifoEn = 0x40;
inline constexpr std::uint8_t kStatusZyxda = 0x08;
inline constexpr std::uint8_t kFifoCtrlStream = 0x40;
inline constexpr std::uint8_t kFifoSrcOverrun = 0x40;
inline constexpr std::uint8_t kFifoSrcEmpty = 0x20;
inline constexpr std::uint8_t kFifoSrcLevel = 0x1F;
inline constexpr std::uint8_t kLowOdrAll = 0x2D;  // level of DRDY, I2C_dis, SW_RES, Low_ODR
}  // namespace bits

/// x, y and z, without a mark.
inline constexpr unsigned kFifoFrameBytes = 6;

}  // namespace zerorate::drivers::l3gd20h

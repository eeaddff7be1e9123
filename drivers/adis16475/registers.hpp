/// @file
/// The registers and bits of the ADIS16475 and its relatives that the driver uses; Analog Devices,
/// ADIS16470 rev. C and ADIS16475 rev. D, user register memory map. Names are Analog's.
#pragma once

#include <cstdint>

namespace zerorate::drivers::adis16475 {

/// Registers are pairs of bytes, the low one at the address given. A read gives both, a write sets
/// one byte.
inline constexpr std::uint8_t kDiagStat = 0x02;
inline constexpr std::uint8_t kDataCntr = 0x22;
inline constexpr std::uint8_t kFiltCtrl = 0x5C;
inline constexpr std::uint8_t kRangMdl = 0x5E;
inline constexpr std::uint8_t kMscCtrl = 0x60;
inline constexpr std::uint8_t kDecRate = 0x64;
inline constexpr std::uint8_t kGlobCmd = 0x68;
inline constexpr std::uint8_t kProdId = 0x72;

/// A read of GLOB_CMD, which is write-only, begins a burst.
inline constexpr std::uint16_t kBurstCommand = 0x6800;
/// Status, three rates, three forces, temperature, counter and checksum.
inline constexpr unsigned kBurstBytes = 20;

/// Bits and fields, named register_field.
namespace bits {
inline constexpr std::uint16_t kWrite = 0x8000;
/// The number of clocks of a transfer before this one was no multiple of 16.
inline constexpr std::uint16_t kDiagStatSpiError = 0x0008;
/// Data path, flash update, standby, sensor, memory and clock; bits 10 to 8 name the sensor in
/// younger relatives.
inline constexpr std::uint16_t kDiagStatFaults = 0x07F6;
inline constexpr std::uint16_t kFiltCtrlSize = 0x0007;
inline constexpr std::uint16_t kRangMdlModel = 0x000C;
/// Compensation of acceleration in the gyro, alignment of the accelerometers, synchronisation,
/// polarity of the pins; 32-bit and delta bursts of younger relatives.
inline constexpr std::uint16_t kMscCtrlAll = 0x03DF;
/// Both compensations on, internal clock, data-ready active high.
inline constexpr std::uint16_t kMscCtrlUsed = 0x00C1;
inline constexpr std::uint16_t kDecRateAll = 0x07FF;
inline constexpr std::uint8_t kGlobCmdReset = 0x80;
}  // namespace bits

}  // namespace zerorate::drivers::adis16475

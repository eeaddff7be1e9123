/// @file
/// The registers and bits of the ADXRS453 that the driver uses; Analog Devices, ADXRS453 rev. B,
/// memory map and SPI commands. Names are Analog's.
#pragma once

#include <cstdint>

namespace zerorate::drivers::adxrs453 {

/// Registers are pairs of bytes; a read gives both, the one of the lower address above.
inline constexpr std::uint8_t kTem1 = 0x02;
inline constexpr std::uint8_t kFault1 = 0x0A;
inline constexpr std::uint8_t kPid1 = 0x0C;
inline constexpr std::uint8_t kSn3 = 0x0E;
inline constexpr std::uint8_t kSn1 = 0x10;

/// Stands for the sensor data in a DriverError: they are the first register too.
inline constexpr std::uint8_t kRate1 = 0x00;

/// The high byte of PID1 and PID0; the low one is a revision.
inline constexpr std::uint8_t kPartId = 0x52;

/// Commands, in bits 31 to 29.
inline constexpr std::uint32_t kSensorData = 0x2000'0000;
inline constexpr std::uint32_t kRead = 0x8000'0000;
inline constexpr unsigned kAddressShift = 17;
inline constexpr std::uint32_t kCheck = 0x0000'0002;  ///< CHK: all faults are asserted on purpose
inline constexpr std::uint32_t kParity = 0x0000'0001;

/// Replies.
inline constexpr std::uint32_t kReadReply = 0x4E00'0000;  ///< 010, P0, 1110
inline constexpr std::uint32_t kReadReplyMask = 0xEF00'0000;
inline constexpr unsigned kReadDataShift = 5;
inline constexpr unsigned kSequenceShift = 29;
inline constexpr unsigned kStatusShift = 26;
inline constexpr unsigned kRateShift = 10;
/// PLL, Q, NVM, POR, PWR, CST, CHK: as the low byte of a reply and of FAULT1 and FAULT0.
inline constexpr std::uint8_t kFaults = 0xFE;
/// Those bits and FAIL, AMP, OV, UV in FAULT1.
inline constexpr std::uint16_t kAllFaults = 0x0FFE;

}  // namespace zerorate::drivers::adxrs453

/// @file
/// Meaning of the bits of the ICM-42688-P and its relatives, as pure functions. Source: TDK
/// DS-000347; README.md gives the source of each fact.
#pragma once

#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/common/packet_gyro.hpp"
#include "drivers/icm42688/registers.hpp"

namespace zerorate::drivers::icm42688 {

/// Part of the family; the values are the answers of WHO_AM_I, in which alone they differ here.
enum class Part : std::uint8_t { icm42605 = 0x42, icm42688 = 0x47, iim42652 = 0x6F };

/// Full scale; the values are the code of GYRO_FS_SEL.
enum class FullScale : std::uint8_t {
  dps_2000 = 0,
  dps_1000 = 1,
  dps_500 = 2,
  dps_250 = 3,
  dps_125 = 4,
  dps_62_5 = 5,
  dps_31_25 = 6,
  dps_15_625 = 7,
};

/// Output data rate; the values are the code of GYRO_ODR.
enum class OutputDataRate : std::uint8_t {
  hz_12_5 = 11,
  hz_25 = 10,
  hz_50 = 9,
  hz_100 = 8,
  hz_200 = 7,
  hz_500 = 15,
  hz_1000 = 6,
  hz_2000 = 5,
};

/// Ends of the range, where the chip clips (DS-000347, rev. 1.2, 12.8: valid are -32766 to 32767).
inline constexpr std::int16_t kHighestRaw = 32767;
inline constexpr std::int16_t kLowestRaw = -32766;

/// The rate of one LSB: full scale by 2^15. The datasheet rounds its inverse to three digits.
[[nodiscard]] constexpr core::AngularRate lsb(FullScale full_scale) {
  const unsigned code = static_cast<unsigned>(full_scale);
  return core::deg_per_s(2000.0F / static_cast<float>(32768U << code));
}

/// Full scale of the accelerometer; the values are the code of ACCEL_FS_SEL.
enum class AccelerationRange : std::uint8_t { g_16 = 0, g_8 = 1, g_4 = 2, g_2 = 3 };

/// The specific force of one LSB: full scale by 2^15.
[[nodiscard]] constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
  const unsigned code = static_cast<unsigned>(range);
  return core::standard_gravity(16.0F / static_cast<float>(32768U << code));
}

/// 132.48 LSB a degree, 0 at 25 degC (DS-000347, 4.13).
[[nodiscard]] constexpr core::Temperature decode_temperature(std::int16_t raw) {
  return core::Temperature::from_degc(25.0F + static_cast<float>(raw) / 132.48F);
}

/// INT_STATUS, FIFO_COUNTH and FIFO_COUNTL.
struct FifoStatus {
  std::uint16_t packets;  ///< complete packets that wait
  bool is_full;           ///< it was full since INT_STATUS was last read: samples may be lost
  bool is_plausible;      ///< the bit that is always 0 is 0, and the FIFO can hold so much
};
template <unsigned kPacketBytes = kShortPacketBytes>
[[nodiscard]] constexpr FifoStatus decode_fifo_status(std::uint8_t int_status,
                                                      std::uint8_t count_high,
                                                      std::uint8_t count_low) {
  const auto bytes = static_cast<std::uint16_t>((count_high << 8U) | count_low);
  return {static_cast<std::uint16_t>(bytes / kPacketBytes),
          (int_status & bits::kIntStatusFifoFull) != 0,
          (int_status & bits::kIntStatusAlwaysZero) == 0 && bytes <= kFifoBytes};
}

/// GYRO_CONFIG0: range and rate.
[[nodiscard]] constexpr std::uint8_t encode_gyro_config0(OutputDataRate rate,
                                                         FullScale full_scale) {
  return static_cast<std::uint8_t>((static_cast<unsigned>(full_scale) << 5U) |
                                   static_cast<unsigned>(rate));
}

/// ACCEL_CONFIG0: range and rate, whose codes are the gyro's.
[[nodiscard]] constexpr std::uint8_t encode_accel_config0(OutputDataRate rate,
                                                          AccelerationRange range) {
  return static_cast<std::uint8_t>((static_cast<unsigned>(range) << 5U) |
                                   static_cast<unsigned>(rate));
}

/// Nominal; the chip's oscillator may be 1.5 % off at 25 degC (DS-000347, table 4).
[[nodiscard]] constexpr core::Duration sample_period(OutputDataRate rate) {
  switch (rate) {
    case OutputDataRate::hz_12_5:
      return core::Duration::milliseconds(80);
    case OutputDataRate::hz_25:
      return core::Duration::milliseconds(40);
    case OutputDataRate::hz_50:
      return core::Duration::milliseconds(20);
    case OutputDataRate::hz_100:
      return core::Duration::milliseconds(10);
    case OutputDataRate::hz_200:
      return core::Duration::milliseconds(5);
    case OutputDataRate::hz_500:
      return core::Duration::milliseconds(2);
    case OutputDataRate::hz_1000:
      return core::Duration::milliseconds(1);
    case OutputDataRate::hz_2000:
      break;
  }
  return core::Duration::microseconds(500);
}

/// Time without access after a software reset.
inline constexpr core::Duration kResetTime = core::Duration::milliseconds(1);

/// Time after power-up until the output may be used: twice the typical start-up time of 30 ms, and
/// three samples for the filter of half the output rate and for samples that are not aligned with
/// our clock.
[[nodiscard]] constexpr core::Duration settling_time(core::Duration period) {
  return core::Duration::milliseconds(60) + period * 3;
}

}  // namespace zerorate::drivers::icm42688

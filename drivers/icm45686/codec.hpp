/// @file
/// Meaning of the bits of the ICM-45686, as pure functions. README.md gives the source of each
/// fact.
#pragma once

#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/common/packet_gyro.hpp"
#include "drivers/icm45686/registers.hpp"

namespace zerorate::drivers::icm45686 {

/// Full scale; the values are the code of GYRO_UI_FS_SEL.
enum class FullScale : std::uint8_t {
  dps_4000 = 0,
  dps_2000 = 1,
  dps_1000 = 2,
  dps_500 = 3,
  dps_250 = 4,
  dps_125 = 5,
  dps_62_5 = 6,
  dps_31_25 = 7,
  dps_15_625 = 8,
};

/// Output data rate; the values are the code of GYRO_ODR and ACCEL_ODR.
enum class OutputDataRate : std::uint8_t {
  hz_12_5 = 12,
  hz_25 = 11,
  hz_50 = 10,
  hz_100 = 9,
  hz_200 = 8,
  hz_400 = 7,
  hz_800 = 6,
  hz_1600 = 5,
};

/// Full scale of the accelerometer; the values are the code of ACCEL_UI_FS_SEL.
enum class AccelerationRange : std::uint8_t { g_16 = 1, g_8 = 2, g_4 = 3, g_2 = 4 };

/// Ends of the range, taken as the ICM-42688-P's.
inline constexpr std::int16_t kHighestRaw = 32767;
inline constexpr std::int16_t kLowestRaw = -32766;

/// The rate of one LSB: full scale by 2^15.
[[nodiscard]] constexpr core::AngularRate lsb(FullScale full_scale) {
  const unsigned code = static_cast<unsigned>(full_scale);
  return core::deg_per_s(4000.0F / static_cast<float>(32768U << code));
}

/// The specific force of one LSB: full scale by 2^15.
[[nodiscard]] constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
  const unsigned code = static_cast<unsigned>(range);
  return core::standard_gravity(32.0F / static_cast<float>(32768U << code));
}

/// 128 LSB a degree, 0 at 25 degC.
[[nodiscard]] constexpr core::Temperature decode_temperature(std::int16_t raw) {
  return core::Temperature::from_degc(25.0F + static_cast<float>(raw) / 128.0F);
}

/// GYRO_CONFIG0: range and rate.
[[nodiscard]] constexpr std::uint8_t encode_gyro_config0(OutputDataRate rate,
                                                         FullScale full_scale) {
  return static_cast<std::uint8_t>((static_cast<unsigned>(full_scale) << 4U) |
                                   static_cast<unsigned>(rate));
}
/// ACCEL_CONFIG0: range and rate.
[[nodiscard]] constexpr std::uint8_t encode_accel_config0(OutputDataRate rate,
                                                          AccelerationRange range) {
  return static_cast<std::uint8_t>((static_cast<unsigned>(range) << 4U) |
                                   static_cast<unsigned>(rate));
}

/// Whether PWR_MGMT0 was read: the gyro is on, and not every bit is 1.
[[nodiscard]] constexpr bool is_power_plausible(std::uint8_t power) {
  constexpr std::uint8_t kOn = bits::kPwrMgmt0GyroLowNoise;
  return (power & kOn) == kOn && power != 0xFF;
}
/// Whether FIFO_CONFIG2 was read: the driver sets bit 3, and not every bit is 1.
[[nodiscard]] constexpr bool is_fifo_config2_plausible(std::uint8_t config) {
  return (config & bits::kFifoConfig2WmGtTh) != 0 && config != 0xFF;
}

/// FIFO_COUNT, which counts packets, low byte first.
struct FifoCount {
  std::uint16_t packets;
  bool is_full;       ///< the FIFO can contain no other one
  bool is_plausible;  ///< the chip's memory can contain so many
};
[[nodiscard]] constexpr FifoCount decode_fifo_count(std::uint8_t low, std::uint8_t high,
                                                    unsigned packet_bytes) {
  const auto packets = static_cast<std::uint16_t>(low | (high << 8U));
  return {packets, packets >= kFifoBytes / packet_bytes, packets <= kMostFifoBytes / packet_bytes};
}

/// Nominal.
[[nodiscard]] constexpr core::Duration sample_period(OutputDataRate rate) {
  const unsigned doublings =
      static_cast<unsigned>(rate) - static_cast<unsigned>(OutputDataRate::hz_1600);
  return core::Duration::microseconds(625) * (std::int64_t{1} << doublings);
}

/// Time without access after a software reset.
inline constexpr core::Duration kResetTime = core::Duration::milliseconds(1);
/// Time from switching a sensor on until registers in its part of the chip take a value. The
/// clock's loop needs 0.2 ms, as a public project quotes the data sheet; the rest is room.
inline constexpr core::Duration kWakeTime = core::Duration::milliseconds(1);

/// Time after power-up until the output may be used: TDK's start-up time of the gyro, and three
/// samples for the filter of a quarter of the output rate.
[[nodiscard]] constexpr core::Duration settling_time(core::Duration period) {
  return core::Duration::milliseconds(70) + period * 3;
}

}  // namespace zerorate::drivers::icm45686

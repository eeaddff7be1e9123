/// @file
/// Meaning of the ICM-20948's bits, as pure functions; README.md gives the source of each fact.
#pragma once

#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/common/fifo_level.hpp"
#include "drivers/icm20948/registers.hpp"

namespace zerorate::drivers::icm20948 {

/// Full scale; the values are the bits GYRO_FS_SEL in place.
enum class FullScale : std::uint8_t {
  dps_250 = 0x00,
  dps_500 = 0x02,
  dps_1000 = 0x04,
  dps_2000 = 0x06,
};

/// Output data rate; the values are the divider of both sensors, which divides 1125 Hz by one more.
enum class OutputDataRate : std::uint8_t {
  hz_12_5 = 89,
  hz_25 = 44,
  hz_45 = 24,
  hz_75 = 14,
  hz_125 = 8,
  hz_225 = 4,
  hz_562_5 = 1,
  hz_1125 = 0,
};

/// Count at which the chip clips.
inline constexpr std::int16_t kFullScaleRaw = 32767;

/// The rate of one LSB: full scale by 2^15. The data sheet rounds its inverse to three digits.
[[nodiscard]] constexpr core::AngularRate lsb(FullScale full_scale) {
  const unsigned code = static_cast<unsigned>(full_scale) >> 1U;
  return core::deg_per_s(static_cast<float>(250U << code) / 32768.0F);
}

/// Full scale of the accelerometer; the values are the bits ACCEL_FS_SEL in place.
enum class AccelerationRange : std::uint8_t { g_2 = 0x00, g_4 = 0x02, g_8 = 0x04, g_16 = 0x06 };

/// The specific force of one LSB: full scale by 2^15 (DS-000189, 3.2).
[[nodiscard]] constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
  const unsigned code = static_cast<unsigned>(range) >> 1U;
  return core::standard_gravity(static_cast<float>(2U << code) / 32768.0F);
}

/// Temperature of a count: 333.87 LSB a degree, 0 at 21 degC.
[[nodiscard]] constexpr core::Temperature decode_temperature(std::int16_t raw) {
  return core::Temperature::from_degc(21.0F + static_cast<float>(raw) / 333.87F);
}

/// Code of the filters whose corner is below half the output rate, in bits 5:3 of GYRO_CONFIG_1 and
/// of ACCEL_CONFIG, with the bit that switches them on. The divider of the gyro works with the
/// codes 1 to 6 (GYRO_SMPLRT_DIV).
[[nodiscard]] constexpr std::uint8_t encode_filter(OutputDataRate rate) {
  unsigned code = 0;
  switch (rate) {
    case OutputDataRate::hz_12_5:
      code = 6;  // 5.7 Hz, accelerometer 5.7 Hz
      break;
    case OutputDataRate::hz_25:
    case OutputDataRate::hz_45:
      code = 5;  // 11.6 Hz, 11.5 Hz
      break;
    case OutputDataRate::hz_75:
      code = 4;  // 23.9 Hz, 23.9 Hz
      break;
    case OutputDataRate::hz_125:
    case OutputDataRate::hz_225:
      code = 3;  // 51.2 Hz, 50.4 Hz
      break;
    case OutputDataRate::hz_562_5:
      code = 1;  // 151.8 Hz, 246 Hz
      break;
    case OutputDataRate::hz_1125:
      code = 0;  // 196.6 Hz, 246 Hz
      break;
  }
  return static_cast<std::uint8_t>((code << 3U) | bits::kFchoice);
}

/// Nominal.
[[nodiscard]] constexpr core::Duration sample_period(OutputDataRate rate) {
  constexpr std::int64_t kBase_hz = 1125;
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t divider = 1 + static_cast<std::int64_t>(rate);
  return core::Duration::nanoseconds((divider * kSecond_ns + kBase_hz / 2) / kBase_hz);
}

/// Level by FIFO_COUNTH and FIFO_COUNTL. A sample is six or twelve bytes, which no FIFO is a
/// multiple of: a full one shows in bytes that are left over. The data sheet has a FIFO of 512
/// bytes, a public project found 4096 (README).
/// @param bytes_each  of a sample
[[nodiscard]] constexpr FifoLevel decode_fifo_level(std::uint8_t high, std::uint8_t low,
                                                    unsigned bytes_each = kFifoSampleBytes) {
  constexpr unsigned kCertain = 512;
  constexpr unsigned kMost = 4096;
  const auto bytes = static_cast<unsigned>((high << 8U) | low);
  return fifo_level(bytes, bytes_each, kCertain, kMost);
}

/// Time until the chip may be used after a reset, and after it was woken, each.
inline constexpr core::Duration kResetTime = core::Duration::milliseconds(100);

/// Time after configuration until the output may be used: twice the gyro's start-up time of 35 ms,
/// and three samples for the filter and for samples that are not aligned with our clock.
[[nodiscard]] constexpr core::Duration settling_time(core::Duration period) {
  return core::Duration::milliseconds(70) + period * 3;
}

}  // namespace zerorate::drivers::icm20948

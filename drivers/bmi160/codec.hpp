/// @file
/// Meaning of the BMI160's bits, as pure functions; README.md gives the source of each fact.
#pragma once

#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/bmi160/registers.hpp"
#include "drivers/common/fifo_level.hpp"

namespace zerorate::drivers::bmi160 {

/// Full scale; the values are the code of GYR_RANGE.
enum class FullScale : std::uint8_t {
  dps_2000 = 0,
  dps_1000 = 1,
  dps_500 = 2,
  dps_250 = 3,
  dps_125 = 4,
};

/// Output data rate; the values are the code of gyr_odr and acc_odr, which is 8 at 100 Hz. Each
/// code above it doubles the rate.
enum class OutputDataRate : std::uint8_t {
  hz_25 = 6,
  hz_50 = 7,
  hz_100 = 8,
  hz_200 = 9,
  hz_400 = 10,
  hz_800 = 11,
  hz_1600 = 12,
};

/// Count at which the chip clips.
inline constexpr std::int16_t kFullScaleRaw = 32767;

/// The rate of one LSB: full scale by 2^15. The data sheet rounds its inverse to one digit.
[[nodiscard]] constexpr core::AngularRate lsb(FullScale full_scale) {
  const unsigned code = static_cast<unsigned>(full_scale);
  return core::deg_per_s(2000.0F / static_cast<float>(32768U << code));
}

/// Full scale of the accelerometer; the values are the code of ACC_RANGE.
enum class AccelerationRange : std::uint8_t { g_2 = 0x03, g_4 = 0x05, g_8 = 0x08, g_16 = 0x0C };

/// The specific force of one LSB: full scale by 2^15.
[[nodiscard]] constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
  switch (range) {
    case AccelerationRange::g_2:
      return core::standard_gravity(2.0F / 32768.0F);
    case AccelerationRange::g_4:
      return core::standard_gravity(4.0F / 32768.0F);
    case AccelerationRange::g_8:
      return core::standard_gravity(8.0F / 32768.0F);
    case AccelerationRange::g_16:
      break;
  }
  return core::standard_gravity(16.0F / 32768.0F);
}

/// Temperature of a count: 512 LSB a degree, 0 at 23 degC.
[[nodiscard]] constexpr core::Temperature decode_temperature(std::int16_t raw) {
  return core::Temperature::from_degc(23.0F + static_cast<float>(raw) * (1.0F / 512.0F));
}

/// True if STATUS can be one of a chip that runs: the line is not stuck.
[[nodiscard]] constexpr bool is_plausible(std::uint8_t status) {
  return (status & bits::kStatusAlwaysZero) == 0 && (status & bits::kStatusNvmRdy) != 0;
}

/// GYR_CONF or ACC_CONF for this rate, with a filter below half of it.
[[nodiscard]] constexpr std::uint8_t encode_conf(OutputDataRate rate) {
  return static_cast<std::uint8_t>(bits::kBandwidthNormal | static_cast<unsigned>(rate));
}

/// FIFO_CONFIG_0 for a watermark of so many frames, in units of four bytes, rounded down: above the
/// level of one frame less, and not above that of these frames.
[[nodiscard]] constexpr std::uint8_t encode_watermark(unsigned frames, unsigned frame_bytes) {
  return static_cast<std::uint8_t>(frames * frame_bytes / 4U);
}

/// Level by FIFO_LENGTH_0 and 1. A frame has six or twelve bytes; 1024 is no multiple of either.
[[nodiscard]] constexpr FifoLevel decode_fifo_length(std::uint8_t low, std::uint8_t high,
                                                     unsigned frame_bytes) {
  const auto bytes = static_cast<unsigned>(low | (high << 8U));
  return fifo_level(bytes, frame_bytes, kFifoBytes);
}

/// Nominal period: the chip has no trim register.
[[nodiscard]] constexpr core::Duration sample_period(OutputDataRate rate) {
  constexpr unsigned kCodeOf1600Hz = 12;
  return core::Duration::microseconds(std::int64_t{625}
                                      << (kCodeOf1600Hz - static_cast<unsigned>(rate)));
}

/// Times until the chip may be used after a reset, and after a sensor was switched on.
inline constexpr core::Duration kResetTime = core::Duration::milliseconds(10);
inline constexpr core::Duration kAccStartUp = core::Duration::milliseconds(5);
inline constexpr core::Duration kGyrStartUp = core::Duration::milliseconds(85);

/// Time after configuration until the output may be used: 30 ms for the filter of a changed rate,
/// and three samples for those that are not aligned with our clock.
[[nodiscard]] constexpr core::Duration settling_time(core::Duration period) {
  return core::Duration::milliseconds(30) + period * 3;
}

}  // namespace zerorate::drivers::bmi160

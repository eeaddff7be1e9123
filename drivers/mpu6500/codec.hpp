/// @file
/// Meaning of the bits of the MPU-6500 and its relatives, as pure functions. Sources: InvenSense
/// PS-MPU-6500A-01 and PS-MPU-6000A-00; README.md gives the source of each fact.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/common/fifo_level.hpp"
#include "drivers/mpu6500/registers.hpp"

namespace zerorate::drivers::mpu6500 {

/// Chip that the driver is for; the values are the answers of WHO_AM_I. As an MPU-6500 it takes
/// whatever is sold as such.
enum class Part : std::uint8_t {
  mpu6500 = 0x70,
  icm20602 = 0x12,
  mpu6886 = 0x19,
  icm20689 = 0x98,
};

/// Use of SIGNAL_PATH_RESET at the start. An MPU-6000 needs it and answers as an MPU-6050, which
/// does not need it and is on I2C alone.
enum class PathReset : std::uint8_t { never, on_spi, always };

/// Chip of the family, identified by its WHO_AM_I. Only the differences are here.
struct Variant {
  std::uint8_t identity;
  std::uint16_t fifo_bytes;   ///< least size of the FIFO
  float counts_per_degree;    ///< slope of the thermometer; 0: not known
  float degc_at_zero_counts;  ///< its temperature at 0 counts
  PathReset path_reset;
  bool has_accel_config_2;   ///< filter of the accelerometer in a register of its own
  std::uint8_t start_up_ms;  ///< until the gyro's output may be used
  /// ICM-20602 and its like: the gyro goes into the FIFO with the temperature alone, and the switch
  /// of the I2C interface stands in I2C_IF.
  bool is_younger;
};

/// Chips that are accepted; README.md gives the reasons.
inline constexpr std::array kVariants{
    // MPU-6050, MPU-6000, MPU-9150
    Variant{0x68, 1024, 340.0F, 36.53F, PathReset::on_spi, false, 70, false},
    // MPU-6500, also where MPU-6050 is written on it
    Variant{0x70, 512, 333.87F, 21.0F, PathReset::always, true, 70, false},
    Variant{0x71, 512, 333.87F, 21.0F, PathReset::always, true, 70, false},  // MPU-9250
    Variant{0x72, 512, 0.0F, 0.0F, PathReset::never, false, 70,
            false},  // no chip of InvenSense's: a copy
    Variant{0x73, 512, 333.87F, 21.0F, PathReset::always, true, 70, false},  // MPU-9255
    Variant{0x74, 512, 333.87F, 21.0F, PathReset::always, true, 70, false},  // MPU-6515
    // ICM-20689, also where MPU-6050 is written on it
    Variant{0x98, 512, 326.8F, 25.0F, PathReset::never, true, 70, false},
    Variant{0x12, 1008, 326.8F, 25.0F, PathReset::never, true, 100, true},  // ICM-20602
    Variant{0x19, 1008, 326.8F, 25.0F, PathReset::never, true, 100, true},  // MPU-6886
};

/// nullptr for a chip that is not accepted.
[[nodiscard]] constexpr const Variant* find_variant(std::uint8_t identity) {
  for (const Variant& variant : kVariants) {
    if (variant.identity == identity) return &variant;
  }
  return nullptr;
}

/// Variant of a part by its own answer.
[[nodiscard]] constexpr const Variant& variant_of(Part part) {
  return *find_variant(static_cast<std::uint8_t>(part));
}

/// True if the driver of this part takes a chip with this answer.
[[nodiscard]] constexpr bool takes(Part part, std::uint8_t identity) {
  if (part != Part::mpu6500) return identity == static_cast<std::uint8_t>(part);
  const Variant* const variant = find_variant(identity);
  return variant != nullptr && !variant->is_younger;
}

/// Bytes of a sample in the FIFO.
/// @param plain_bytes  without a temperature
[[nodiscard]] constexpr unsigned sample_bytes(const Variant& variant, unsigned plain_bytes) {
  return plain_bytes + (variant.is_younger ? kTemperatureBytes : 0U);
}

/// Full scale; the values are the bits GYRO_FS_SEL in place.
enum class FullScale : std::uint8_t {
  dps_250 = 0x00,
  dps_500 = 0x08,
  dps_1000 = 0x10,
  dps_2000 = 0x18,
};

/// Output data rate; the values are SMPLRT_DIV, which divides 1 kHz by one more.
enum class OutputDataRate : std::uint8_t {
  hz_12_5 = 79,
  hz_25 = 39,
  hz_50 = 19,
  hz_100 = 9,
  hz_125 = 7,
  hz_200 = 4,
  hz_250 = 3,
  hz_500 = 1,
  hz_1000 = 0,
};

/// The chip clips here.
inline constexpr std::int16_t kFullScaleRaw = 32767;

/// The rate of one LSB: full scale by 2^15. The data sheet rounds its inverse to three digits.
[[nodiscard]] constexpr core::AngularRate lsb(FullScale full_scale) {
  const unsigned code = static_cast<unsigned>(full_scale) >> 3U;
  return core::deg_per_s(static_cast<float>(250U << code) / 32768.0F);
}

/// Full scale of the accelerometer; the values are the bits ACCEL_FS_SEL in place.
enum class AccelerationRange : std::uint8_t { g_2 = 0x00, g_4 = 0x08, g_8 = 0x10, g_16 = 0x18 };

/// The specific force of one LSB: full scale by 2^15 (PS-MPU-6000A-00, 6.2).
[[nodiscard]] constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
  const unsigned code = static_cast<unsigned>(range) >> 3U;
  return core::standard_gravity(static_cast<float>(2U << code) / 32768.0F);
}

/// Temperature by the figures of `variant`, which must have them.
[[nodiscard]] constexpr core::Temperature decode_temperature(const Variant& variant,
                                                             std::int16_t raw) {
  return core::Temperature::from_degc(variant.degc_at_zero_counts +
                                      static_cast<float>(raw) / variant.counts_per_degree);
}

/// Code of the low-pass filter whose corner is below half the output rate; at 1 kHz the widest one,
/// 184 Hz. A sample rate of 1 kHz inside needs a code from 1 to 6.
[[nodiscard]] constexpr std::uint8_t low_pass(OutputDataRate rate) {
  switch (rate) {
    case OutputDataRate::hz_1000:
    case OutputDataRate::hz_500:
      return 1;  // 184 Hz
    case OutputDataRate::hz_250:
    case OutputDataRate::hz_200:
      return 2;  // 92 Hz
    case OutputDataRate::hz_125:
    case OutputDataRate::hz_100:
      return 3;  // 41 Hz
    case OutputDataRate::hz_50:
      return 4;  // 20 Hz
    case OutputDataRate::hz_25:
      return 5;  // 10 Hz
    case OutputDataRate::hz_12_5:
      break;
  }
  return 6;  // 5 Hz
}

/// Nominal: with the gyro as its clock the chip is within 1 %.
[[nodiscard]] constexpr core::Duration sample_period(OutputDataRate rate) {
  return core::Duration::milliseconds(1 + static_cast<std::int64_t>(rate));
}

/// FIFO_COUNTH and FIFO_COUNTL. A sample is six or twelve bytes, which no FIFO is a multiple of: a
/// full one shows in bytes that are left over. With the temperature it is eight or fourteen, and
/// the temperature is its mark.
/// @param plain_bytes  of a sample, without a temperature
[[nodiscard]] constexpr FifoLevel decode_fifo_level(const Variant& variant, std::uint8_t high,
                                                    std::uint8_t low,
                                                    unsigned plain_bytes = kFifoSampleBytes) {
  const auto bytes = static_cast<unsigned>((high << 8U) | low);
  const unsigned size = sample_bytes(variant, plain_bytes);
  return fifo_level(bytes, size, variant.fifo_bytes);
}

/// True if the temperature in a sample of the FIFO is within 5 degC of the register's: it shows
/// where a sample begins. A FIFO holds some ten seconds at most.
[[nodiscard]] constexpr bool is_marked(std::int16_t in_fifo, std::int16_t in_register) {
  constexpr int kNear = 5 * 327;
  const int apart = in_fifo - in_register;
  return apart < kNear && apart > -kNear;
}

/// Time until the chip may be used after a reset of the whole, and of its signal paths, each.
inline constexpr core::Duration kResetTime = core::Duration::milliseconds(100);

/// Time after configuration until the output may be used: twice the start-up time of 35 ms (with
/// the ICM-20602 100 ms, as Linux waits), and three samples for the filter and for samples that are
/// not aligned with our clock.
[[nodiscard]] constexpr core::Duration settling_time(const Variant& variant,
                                                     core::Duration period) {
  return core::Duration::milliseconds(variant.start_up_ms) + period * 3;
}

}  // namespace zerorate::drivers::mpu6500

/// @file
/// Meaning of the BMI270's bits, as pure functions; README.md gives the source of each fact.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/bmi270/registers.hpp"
#include "drivers/common/fifo_level.hpp"

namespace zerorate::drivers::bmi270 {

/// Full scale; the values are the code of gyr_range.
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

/// The rate of one LSB: full scale by 2^15.
[[nodiscard]] constexpr core::AngularRate lsb(FullScale full_scale) {
  const unsigned code = static_cast<unsigned>(full_scale);
  return core::deg_per_s(2000.0F / static_cast<float>(32768U << code));
}

/// GYR_RANGE. At the widest range that of the second interface is set to it too: public drivers saw
/// another scale in the FIFO without it (README).
[[nodiscard]] constexpr std::uint8_t encode_range(FullScale full_scale) {
  constexpr unsigned kSecondInterface = 0x08;
  const unsigned code = static_cast<unsigned>(full_scale);
  return static_cast<std::uint8_t>(full_scale == FullScale::dps_2000 ? kSecondInterface : code);
}

/// Full scale of the accelerometer; the values are the code of ACC_RANGE.
enum class AccelerationRange : std::uint8_t { g_2 = 0, g_4 = 1, g_8 = 2, g_16 = 3 };

/// The specific force of one LSB: full scale by 2^15.
[[nodiscard]] constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
  return core::standard_gravity(static_cast<float>(2U << static_cast<unsigned>(range)) / 32768.0F);
}

/// Temperature of a count: 512 LSB a degree, 0 at 23 degC.
[[nodiscard]] constexpr core::Temperature decode_temperature(std::int16_t raw) {
  return core::Temperature::from_degc(23.0F + static_cast<float>(raw) * (1.0F / 512.0F));
}

/// True if INTERNAL_STATUS is that of a chip that took its file: the line is not stuck, and the
/// chip has not lost its supply since.
[[nodiscard]] constexpr bool is_initialised(std::uint8_t internal_status) {
  return (internal_status & bits::kInternalStatusMessage) == bits::kInternalStatusInitOk;
}

/// True if a file of this size can be Bosch's: whole words, and no more than the chip's memory.
[[nodiscard]] constexpr bool is_config_file_size(std::size_t bytes) {
  constexpr std::size_t kMost = 8192;
  return bytes > 0 && bytes <= kMost && bytes % 2 == 0;
}

/// True if the file has features, and with them GYR_CAS: all but Bosch's file for the longest FIFO.
[[nodiscard]] constexpr bool has_features(std::size_t file_bytes) {
  constexpr std::size_t kMaximumFifo = 328;
  return file_bytes != kMaximumFifo;
}

/// Share of the rate about z in the output of x, by GYR_CAS: seven bits, two's complement, 1/512
/// each.
[[nodiscard]] constexpr float decode_cross_sensitivity(std::uint8_t gyr_cas) {
  const int factor = static_cast<int>(gyr_cas & 0x3FU) - static_cast<int>(gyr_cas & 0x40U);
  return static_cast<float>(factor) / 512.0F;
}

/// INIT_ADDR_0 and INIT_ADDR_1 for the word at so many bytes: its number, whose lowest four bits go
/// into the first.
struct InitAddress {
  std::uint8_t low;
  std::uint8_t high;
};
[[nodiscard]] constexpr InitAddress encode_init_address(std::size_t bytes) {
  const std::size_t word = bytes / 2;
  return {static_cast<std::uint8_t>(word & 0x0FU), static_cast<std::uint8_t>(word >> 4U)};
}

/// Level by FIFO_LENGTH_0 and 1, 14 bits. A frame has six or twelve bytes; 2048 is no multiple of
/// either. Where the file gives a longer FIFO, a level above 2048 bytes counts as an overrun all
/// the same.
[[nodiscard]] constexpr FifoLevel decode_fifo_length(std::uint8_t low, std::uint8_t high,
                                                     unsigned frame_bytes) {
  const auto bytes = static_cast<unsigned>(low | ((high & 0x3FU) << 8U));
  return fifo_level(bytes, frame_bytes, kFifoBytes, kLongestFifoBytes);
}

/// True if a frame has no rate, because the gyro had none: the chip fills its place in this way.
[[nodiscard]] constexpr bool is_placeholder(const std::array<std::int16_t, 3>& raw) {
  return raw[0] == 0x7F02 && raw[1] == -32768;
}

/// Nominal period: the chip has no trim register.
[[nodiscard]] constexpr core::Duration sample_period(OutputDataRate rate) {
  constexpr unsigned kCodeOf1600Hz = 12;
  return core::Duration::microseconds(std::int64_t{625}
                                      << (kCodeOf1600Hz - static_cast<unsigned>(rate)));
}

/// Times until the chip may be used: after chip select rose for the first time, after a reset,
/// after its power save was switched off, and after its file was loaded.
inline constexpr core::Duration kInterfaceTime = core::Duration::milliseconds(2);
inline constexpr core::Duration kResetTime = core::Duration::milliseconds(10);
inline constexpr core::Duration kWakeTime = core::Duration::milliseconds(1);
inline constexpr core::Duration kLoadTime = core::Duration::milliseconds(150);

/// Time after configuration until the output may be used: nearly twice the start-up time of the
/// gyro, 45 ms, and three samples for those that are not aligned with our clock.
[[nodiscard]] constexpr core::Duration settling_time(core::Duration period) {
  return core::Duration::milliseconds(85) + period * 3;
}

}  // namespace zerorate::drivers::bmi270

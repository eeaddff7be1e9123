/// @file
/// Meaning of the words of the ADIS16475 and its relatives, as pure functions; README.md gives the
/// source of each fact.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/adis16475/registers.hpp"

namespace zerorate::drivers::adis16475 {

/// Part of the family, by its name in the order code.
enum class Part : std::uint8_t { adis16470, adis16475_1, adis16475_2, adis16475_3 };

/// Figures that differ between the parts.
struct Variant {
  std::uint16_t product;        ///< content of PROD_ID: the number in the part's name
  std::uint16_t model;          ///< field of RANG_MDL; kNoModel where the register has no meaning
  std::int16_t full_scale_dps;  ///< 20,000 counts
  std::int16_t range_g;         ///< 32,000 counts
};
inline constexpr std::uint16_t kNoModel = 0xFFFF;

/// Variants in the order of Part.
inline constexpr std::array kVariants{
    Variant{16470, kNoModel, 2000, 40}, Variant{16475, 0x0000, 125, 8},
    Variant{16475, 0x0004, 500, 8}, Variant{16475, 0x000C, 2000, 8}};
[[nodiscard]] constexpr const Variant& variant(Part part) {
  return kVariants[static_cast<std::size_t>(part)];
}

/// Counts at the end of the specified ranges; the outputs go on beyond them.
inline constexpr std::int16_t kFullScaleRaw = 20'000;
inline constexpr std::int16_t kAccelerationFullScaleRaw = 32'000;

/// The rate of one LSB: 6.25, 25 or 100 mdps.
[[nodiscard]] constexpr core::AngularRate lsb(const Variant& variant) {
  return core::deg_per_s(static_cast<float>(variant.full_scale_dps) / float{kFullScaleRaw});
}
/// The specific force of one LSB: 0.25 or 1.25 mg.
[[nodiscard]] constexpr core::Acceleration acceleration_lsb(const Variant& variant) {
  return core::standard_gravity(static_cast<float>(variant.range_g) /
                                float{kAccelerationFullScaleRaw});
}

/// Output data rate; the values are how many samples of 2000 Hz the chip averages.
enum class OutputDataRate : std::uint8_t {
  hz_2000 = 1,
  hz_1000 = 2,
  hz_500 = 4,
  hz_400 = 5,
  hz_250 = 8,
  hz_200 = 10,
  hz_125 = 16,
  hz_100 = 20,
};

/// DEC_RATE for this rate.
[[nodiscard]] constexpr std::uint16_t encode_dec_rate(OutputDataRate rate) {
  return static_cast<std::uint16_t>(static_cast<unsigned>(rate) - 1U);
}
/// Nominal period: the chip has no trim register.
[[nodiscard]] constexpr core::Duration sample_period(OutputDataRate rate) {
  return core::Duration::microseconds(500) * static_cast<std::int64_t>(rate);
}

/// Word that asks for a register.
[[nodiscard]] constexpr std::uint16_t encode_read(std::uint8_t address) {
  return static_cast<std::uint16_t>(address << 8U);
}
/// Word that writes one byte.
[[nodiscard]] constexpr std::uint16_t encode_write(std::uint8_t address, std::uint8_t value) {
  return static_cast<std::uint16_t>(bits::kWrite | (address << 8U) | value);
}

/// Temperature of a count: 10 LSB a degree, 0 at 0 degC.
[[nodiscard]] constexpr core::Temperature decode_temperature(std::int16_t raw) {
  return core::Temperature::from_degc(static_cast<float>(raw) * 0.1F);
}

/// Content of a burst.
struct Burst {
  std::uint16_t status = 0;  ///< DIAG_STAT
  std::array<std::int16_t, 3> rate{};
  std::array<std::int16_t, 3> force{};
  std::int16_t temperature = 0;
  std::uint16_t counter = 0;  ///< DATA_CNTR: samples since the reset, modulo 2^16
  /// Whether the checksum is that of the bytes, and not all of them are 0: a line that is stuck at
  /// 0 gives a right checksum.
  bool is_intact = false;
};

/// The checksum is the sum of the bytes before it.
[[nodiscard]] constexpr Burst decode_burst(std::span<const std::uint8_t, kBurstBytes> bytes) {
  const auto word = [&](std::size_t index) {
    return static_cast<std::uint16_t>((bytes[2 * index] << 8U) | bytes[2 * index + 1]);
  };
  const auto value = [&](std::size_t index) { return static_cast<std::int16_t>(word(index)); };
  constexpr std::size_t kChecksumAt = 9;
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes.first<2 * kChecksumAt>()) sum += byte;
  return {.status = word(0),
          .rate = {value(1), value(2), value(3)},
          .force = {value(4), value(5), value(6)},
          .temperature = value(7),
          .counter = word(8),
          .is_intact = sum != 0 && sum == word(kChecksumAt)};
}

/// True if the chip cannot have measured so many samples in this time: it has been reset, and
/// counts from 0 again. Twice the nominal number are allowed, and some more.
[[nodiscard]] constexpr bool was_reset(std::uint16_t steps, core::Duration passed,
                                       core::Duration period) {
  constexpr std::int64_t kSlack = 8;
  return steps > 2 * (passed.ns() / period.ns()) + kSlack;
}

/// Time until the chip answers after its supply came, and after a reset.
inline constexpr core::Duration kStartUpTime = core::Duration::milliseconds(310);
/// Time until registers have taken what was written to them.
inline constexpr core::Duration kWriteTime = core::Duration::milliseconds(1);

/// Time after configuration until the output may be used: 5 ms for the filters in front of the
/// average, and three samples for those that were averaged in part.
[[nodiscard]] constexpr core::Duration settling_time(core::Duration period) {
  return core::Duration::milliseconds(5) + period * 3;
}

}  // namespace zerorate::drivers::adis16475

/// @file
/// Meaning of the bits of the LSM6DSO and its relatives, as pure functions. Sources: ST DS12140
/// (table 2 for sensitivities, chapter 9 for fields); README.md names what the datasheet leaves
/// open.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/lsm6dso/registers.hpp"

namespace zerorate::drivers::lsm6dso {

/// Chip of the family.
enum class Model : std::uint8_t { lsm6dso, ism330dhcx, asm330lhh };

/// Figures in which the chips differ. Addresses, fields, rates, FIFO and times that the driver uses
/// are the same in all of them.
struct Variant {
  std::uint8_t identity;  ///< of WHO_AM_I; two of them answer alike
  bool has_4000_dps;
};

/// By Model.
inline constexpr std::array kVariants{Variant{0x6C, false}, Variant{0x6B, true},
                                      Variant{0x6B, true}};
[[nodiscard]] constexpr Variant variant(Model model) {
  return kVariants[static_cast<std::size_t>(model)];
}

/// Nominal full scale; the values are the bits FS_G, FS_125 and FS_4000 in place (CTRL2_G).
enum class FullScale : std::uint8_t {
  dps_125 = 0x02,
  dps_250 = 0x00,
  dps_500 = 0x04,
  dps_1000 = 0x08,
  dps_2000 = 0x0C,
  dps_4000 = 0x01,  ///< not of the LSM6DSO
};

/// Output data rate by its nominal name; the values are the code of ODR_G and BDR_GY.
enum class OutputDataRate : std::uint8_t {
  hz_12_5 = 1,
  hz_26 = 2,
  hz_52 = 3,
  hz_104 = 4,
  hz_208 = 5,
  hz_416 = 6,
  hz_833 = 7,
  hz_1666 = 8,
  hz_3332 = 9,
  hz_6664 = 10,
};

/// In every range the nominal full scale is this many LSB: 125 / 0.004375 = 250 / 0.00875 = ...
/// Beyond it the chip still counts, but the datasheet promises nothing.
inline constexpr std::int16_t kFullScaleRaw = 28571;

/// The rate of one LSB.
[[nodiscard]] constexpr core::AngularRate lsb(FullScale full_scale) {
  switch (full_scale) {
    case FullScale::dps_125:
      return core::deg_per_s(4.375e-3F);
    case FullScale::dps_250:
      return core::deg_per_s(8.75e-3F);
    case FullScale::dps_500:
      return core::deg_per_s(17.5e-3F);
    case FullScale::dps_1000:
      return core::deg_per_s(35e-3F);
    case FullScale::dps_2000:
      return core::deg_per_s(70e-3F);
    case FullScale::dps_4000:
      break;
  }
  return core::deg_per_s(140e-3F);
}

/// 256 LSB a degree, 0 at 25 degC (DS12140, temperature sensor characteristics).
[[nodiscard]] constexpr core::Temperature decode_temperature(std::int16_t raw) {
  return core::Temperature::from_degc(25.0F + static_cast<float>(raw) * (1.0F / 256.0F));
}

/// FIFO_STATUS1 and FIFO_STATUS2.
struct FifoStatus {
  std::uint16_t words;  ///< unread, at most 1023
  bool is_overrun;      ///< words were overwritten since FIFO_STATUS2 was last read
  bool is_plausible;    ///< the bit that is always 0 is 0
};
[[nodiscard]] constexpr FifoStatus decode_fifo_status(std::uint8_t status1, std::uint8_t status2) {
  return {static_cast<std::uint16_t>(status1 | ((status2 & bits::kFifoStatus2Diff) << 8U)),
          (status2 & bits::kFifoStatus2OvrLatched) != 0,
          (status2 & bits::kFifoStatus2AlwaysZero) == 0};
}

/// True if a FIFO word's tag byte says gyro and its parity, even over all eight bits, is right.
[[nodiscard]] constexpr bool is_gyro_tag(std::uint8_t tag) {
  return (tag >> 3U) == kTagGyro && std::popcount(tag) % 2 == 0;
}

/// CTRL2_G: the sensor runs at this rate and range.
[[nodiscard]] constexpr std::uint8_t encode_ctrl2_g(OutputDataRate rate, FullScale full_scale) {
  return static_cast<std::uint8_t>((static_cast<unsigned>(rate) << 4U) |
                                   static_cast<unsigned>(full_scale));
}

/// The true period of a chip whose INTERNAL_FREQ_FINE holds this trim: its rate is
/// 6667 Hz (1 + 0.0015 trim) / 2^k; nominal "104 Hz" is 104.17 Hz.
[[nodiscard]] constexpr core::Duration decode_period(OutputDataRate rate, std::int8_t trim) {
  const std::int64_t divider = std::int64_t{1} << (10U - static_cast<unsigned>(rate));
  const std::int64_t tenth_mhz = std::int64_t{6667} * (10'000 + 15 * trim);
  return core::Duration::nanoseconds(divider * 10'000'000'000'000 / tenth_mhz);
}

/// How long after power-up the output may not be used: 70 ms and a number of samples that depends
/// on the rate, with LPF1 off and in high-performance mode (AN5040, tables 14 and 15), and one more
/// sample, since the chip's samples are not aligned with our clock.
[[nodiscard]] constexpr core::Duration settling_time(OutputDataRate rate, core::Duration period) {
  constexpr std::array<std::uint16_t, 10> kDiscard{2, 3, 3, 3, 3, 3, 3, 135, 270, 540};
  const std::int64_t samples = kDiscard[static_cast<std::size_t>(rate) - 1] + 1;
  return core::Duration::milliseconds(70) + period * samples;
}

}  // namespace zerorate::drivers::lsm6dso

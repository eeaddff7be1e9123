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

/// Part of the family, by the name in its data sheet.
enum class Part : std::uint8_t {
  lsm6dso,
  ism330dhcx,
  asm330lhh,
  lsm6dsv16x,
  lsm6dsr,
  lsm6dsox,
  lsm6dsl,
  lsm6ds3tr_c,
};

/// Figures in which the chips differ. Addresses and fields of outputs, status and identity are the
/// same in all of them, those of the FIFO's data in all that have tags.
struct Variant {
  std::uint8_t identity;  ///< answer of WHO_AM_I; up to three chips share one
  bool has_4000_dps;
  bool has_tags;        ///< FIFO of tagged words; the FIFO without tags is not used
  bool has_i3c;         ///< I3C_disable, or in its place device_conf
  bool has_new_layout;  ///< range in CTRL6, FIFO_STATUS1 at 1Bh, trim at 4Fh
  bool has_tag_parity;
  std::uint8_t status_always_zero;  ///< bits of STATUS_REG
  std::uint8_t level_high_bits;     ///< level of the FIFO in FIFO_STATUS2
  std::uint8_t level_always_zero;   ///< bits of FIFO_STATUS2
  std::uint8_t fastest_code;        ///< code of the fastest output data rate
  std::uint16_t fastest_hz;         ///< each code below it halves the rate
  std::uint8_t trim_step;           ///< step of the oscillator [0.01 %]; 0: no trim register
};

/// Variants in the order of Part.
inline constexpr Variant kLsm6dso{.identity = 0x6C,
                                  .has_4000_dps = false,
                                  .has_tags = true,
                                  .has_i3c = true,
                                  .has_new_layout = false,
                                  .has_tag_parity = true,
                                  .status_always_zero = 0xF8,
                                  .level_high_bits = 0x03,
                                  .level_always_zero = 0x04,
                                  .fastest_code = 10,
                                  .fastest_hz = 6667,
                                  .trim_step = 15};
inline constexpr Variant kIsm330dhcx = [] {
  Variant relative = kLsm6dso;
  relative.identity = 0x6B;
  relative.has_4000_dps = true;
  return relative;
}();
inline constexpr Variant kLsm6dsl = [] {
  Variant relative = kLsm6dso;
  relative.identity = 0x6A;
  relative.has_tags = false;
  relative.has_i3c = false;
  relative.trim_step = 0;
  return relative;
}();
inline constexpr std::array kVariants{kLsm6dso,
                                      kIsm330dhcx,
                                      kIsm330dhcx,
                                      Variant{.identity = 0x70,
                                              .has_4000_dps = true,
                                              .has_tags = true,
                                              .has_i3c = false,
                                              .has_new_layout = true,
                                              .has_tag_parity = false,
                                              .status_always_zero = 0x40,
                                              .level_high_bits = 0x01,
                                              .level_always_zero = 0x06,
                                              .fastest_code = 12,
                                              .fastest_hz = 7680,
                                              .trim_step = 13},
                                      kIsm330dhcx,
                                      kLsm6dso,
                                      kLsm6dsl,
                                      kLsm6dsl};
[[nodiscard]] constexpr const Variant& variant(Part part) {
  return kVariants[static_cast<std::size_t>(part)];
}

/// Nominal full scale; the values are the bits FS_G, FS_125 and FS_4000 in place (CTRL2_G of all
/// but the LSM6DSV16X).
enum class FullScale : std::uint8_t {
  dps_125 = 0x02,
  dps_250 = 0x00,
  dps_500 = 0x04,
  dps_1000 = 0x08,
  dps_2000 = 0x0C,
  dps_4000 = 0x01,  ///< not of every chip
};

/// Output data rate of all but the LSM6DSV16X by its nominal name; the values are the code of ODR_G
/// and BDR_GY.
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
/// Output data rate of the LSM6DSV16X.
enum class DsvRate : std::uint8_t {
  hz_7_5 = 2,
  hz_15 = 3,
  hz_30 = 4,
  hz_60 = 5,
  hz_120 = 6,
  hz_240 = 7,
  hz_480 = 8,
  hz_960 = 9,
  hz_1920 = 10,
  hz_3840 = 11,
  hz_7680 = 12,
};

/// In every range the nominal full scale is this many LSB: 125 / 0.004375 = 250 / 0.00875 = ...
/// Beyond it the chip still counts, but no accuracy is specified.
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

/// Nominal full scale of the accelerometer; the values are the code of FS_XL in the LSM6DSV16X.
enum class AccelerationRange : std::uint8_t { g_2, g_4, g_8, g_16 };

/// Code of FS_XL of all but the LSM6DSV16X (CTRL1_XL): 16 g stands between 2 g and 4 g.
[[nodiscard]] constexpr std::uint8_t encode_fs_xl(AccelerationRange range) {
  constexpr std::array<std::uint8_t, 4> kCodes{0, 2, 3, 1};
  return kCodes[static_cast<std::size_t>(range)];
}

/// The specific force of one LSB: 0.061, 0.122, 0.244, 0.488 mg (DS12140, table 2). The output
/// ends at 32767 LSB, in every range just below the nominal full scale.
[[nodiscard]] constexpr core::Acceleration acceleration_lsb(AccelerationRange range) {
  const unsigned code = static_cast<unsigned>(range);
  return core::standard_gravity(0.061e-3F * static_cast<float>(1U << code));
}

/// 256 LSB a degree, 0 at 25 degC (DS12140, temperature sensor characteristics).
[[nodiscard]] constexpr core::Temperature decode_temperature(std::int16_t raw) {
  return core::Temperature::from_degc(25.0F + static_cast<float>(raw) * (1.0F / 256.0F));
}

/// FIFO_STATUS1 and FIFO_STATUS2.
struct FifoStatus {
  std::uint16_t words;  ///< unread, at most 1023
  bool is_overrun;      ///< words were overwritten since FIFO_STATUS2 was last read
  bool is_plausible;    ///< the bits that are always 0 are 0
};
[[nodiscard]] constexpr FifoStatus decode_fifo_status(const Variant& variant, std::uint8_t status1,
                                                      std::uint8_t status2) {
  return {static_cast<std::uint16_t>(status1 | ((status2 & variant.level_high_bits) << 8U)),
          (status2 & bits::kFifoStatus2OvrLatched) != 0,
          (status2 & variant.level_always_zero) == 0};
}

/// True if the tag byte of a FIFO word means this sensor and its parity, even over all eight bits,
/// is right where it has one.
[[nodiscard]] constexpr bool is_tag_of(const Variant& variant, std::uint8_t sensor,
                                       std::uint8_t tag) {
  return (tag >> 3U) == sensor && (!variant.has_tag_parity || std::popcount(tag) % 2 == 0);
}
[[nodiscard]] constexpr bool is_gyro_tag(const Variant& variant, std::uint8_t tag) {
  return is_tag_of(variant, kTagGyro, tag);
}

/// TAG_CNT: words of one time slot have the same.
[[nodiscard]] constexpr std::uint8_t time_slot(std::uint8_t tag) {
  return (tag >> 1U) & 3U;
}

/// CTRL2_G of all but the LSM6DSV16X: the sensor runs at this rate and range.
/// @param rate  code of the output data rate
[[nodiscard]] constexpr std::uint8_t encode_ctrl2_g(std::uint8_t rate, FullScale full_scale) {
  return static_cast<std::uint8_t>((unsigned{rate} << 4U) | static_cast<unsigned>(full_scale));
}

/// CTRL1_XL of all but the LSM6DSV16X: the accelerometer runs at this rate and range, without LPF2.
/// @param rate  code of the output data rate
[[nodiscard]] constexpr std::uint8_t encode_ctrl1_xl(std::uint8_t rate, AccelerationRange range) {
  return static_cast<std::uint8_t>((unsigned{rate} << 4U) | (unsigned{encode_fs_xl(range)} << 2U));
}

/// FS_G of the LSM6DSV16X (CTRL6).
[[nodiscard]] constexpr std::uint8_t encode_ctrl6(FullScale full_scale) {
  switch (full_scale) {
    case FullScale::dps_125:
      return 0x0;
    case FullScale::dps_250:
      return 0x1;
    case FullScale::dps_500:
      return 0x2;
    case FullScale::dps_1000:
      return 0x3;
    case FullScale::dps_2000:
      return 0x4;
    case FullScale::dps_4000:
      break;
  }
  return 0xC;
}

/// The true period of a chip with this trim, a count of INTERNAL_FREQ_FINE: the LSM6DSO's rate is
/// 6667 Hz (1 + 0.0015 trim) / 2^k, and its nominal "104 Hz" is 104.17 Hz.
/// @param rate  code of the output data rate
[[nodiscard]] constexpr core::Duration decode_period(const Variant& variant, unsigned rate,
                                                     std::int8_t trim) {
  const std::int64_t divider = std::int64_t{1} << (variant.fastest_code - rate);
  const std::int64_t tenth_mhz =
      std::int64_t{variant.fastest_hz} * (10'000 + variant.trim_step * trim);
  return core::Duration::nanoseconds(divider * 10'000'000'000'000 / tenth_mhz);
}

/// Time after power-up until the output may be used: 70 ms and a number of samples that depends on
/// the rate, with LPF1 off and in high-performance mode (AN5040, tables 14 and 15), and one more
/// sample, since the chip's samples are not aligned with our clock. For the other chips the same
/// is assumed.
/// @param rate  code of the output data rate
[[nodiscard]] constexpr core::Duration settling_time(const Variant& variant, unsigned rate,
                                                     core::Duration period) {
  constexpr std::array<std::uint16_t, 13> kDiscard{540, 270, 135, 3, 3, 3, 3, 3, 3, 2, 2, 2, 2};
  const std::int64_t samples = kDiscard[variant.fastest_code - rate] + 1;
  return core::Duration::milliseconds(70) + period * samples;
}

}  // namespace zerorate::drivers::lsm6dso

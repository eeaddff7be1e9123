/// @file
/// Meaning of the bits of the L3GD20H and its relatives, as pure functions; README.md gives the
/// source of each fact.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/l3gd20h/registers.hpp"

namespace zerorate::drivers::l3gd20h {

/// Part of the family, by the name in its data sheet.
enum class Part : std::uint8_t { l3gd20h, l3gd20, l3g4200d };

/// Figures that differ between the chips.
struct Variant {
  std::uint8_t identity;   ///< answer of WHO_AM_I
  std::uint8_t lowest_hz;  ///< output data rate of code 0; each code above it doubles the rate
  bool has_low_odr;        ///< whether there is a register LOW_ODR (39h)
};

/// Variants in the order of Part.
inline constexpr std::array kVariants{Variant{0xD7, 100, true}, Variant{0xD4, 95, false},
                                      Variant{0xD3, 100, false}};
[[nodiscard]] constexpr const Variant& variant(Part part) {
  return kVariants[static_cast<std::size_t>(part)];
}

/// Nominal full scale; the values are the bits FS in place. By its data sheet the L3GD20H has 245
/// in the place of 250 deg/s, at the same sensitivity.
enum class FullScale : std::uint8_t { dps_250 = 0x00, dps_500 = 0x10, dps_2000 = 0x20 };

/// Output data rate as a multiple of the lowest one; the values are the code of DR.
enum class OutputDataRate : std::uint8_t { times_1 = 0, times_2 = 1, times_4 = 2, times_8 = 3 };

/// Nominal full scale in LSB, the same in every range: 250 / 0.00875 = 500 / 0.0175 = ...
inline constexpr std::int16_t kFullScaleRaw = 28571;

/// The rate of one LSB: 8.75, 17.5, 70 mdps.
[[nodiscard]] constexpr core::AngularRate lsb(FullScale full_scale) {
  switch (full_scale) {
    case FullScale::dps_250:
      return core::deg_per_s(8.75e-3F);
    case FullScale::dps_500:
      return core::deg_per_s(17.5e-3F);
    case FullScale::dps_2000:
      break;
  }
  return core::deg_per_s(70e-3F);
}

/// CTRL1 for a sensor that runs at this rate. The bandwidth is that of LPF1, and follows from it.
[[nodiscard]] constexpr std::uint8_t encode_ctrl1(OutputDataRate rate) {
  return static_cast<std::uint8_t>((static_cast<unsigned>(rate) << 6U) | bits::kCtrl1On);
}

/// Content of FIFO_SRC.
struct FifoStatus {
  std::uint8_t frames;  ///< complete frames that wait, at most 31 where is_full is false
  bool is_full;         ///< whether 32 wait: the next one overwrites the oldest, or has done so
  bool is_plausible;    ///< false where the FIFO is empty and filled at the same time
};
[[nodiscard]] constexpr FifoStatus decode_fifo_src(std::uint8_t value) {
  const auto frames = static_cast<std::uint8_t>(value & bits::kFifoSrcLevel);
  const bool is_empty = (value & bits::kFifoSrcEmpty) != 0;
  const bool is_full = (value & bits::kFifoSrcOverrun) != 0;
  return {frames, is_full, !is_empty || (frames == 0 && !is_full)};
}

/// Nominal period: the chip has no trim register.
[[nodiscard]] constexpr core::Duration sample_period(const Variant& variant, OutputDataRate rate) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t rate_hz = std::int64_t{variant.lowest_hz} << static_cast<unsigned>(rate);
  return core::Duration::nanoseconds(kSecond_ns / rate_hz);
}

/// Time for the chip to load its trimming again.
inline constexpr core::Duration kBootTime = core::Duration::milliseconds(10);

/// Time after power-up until the output may be used: 300 ms, more than the turn-on time of 250 ms
/// of the oldest chip, and three samples for the filter and for samples that are not aligned with
/// our clock.
[[nodiscard]] constexpr core::Duration settling_time(core::Duration period) {
  return core::Duration::milliseconds(300) + period * 3;
}

}  // namespace zerorate::drivers::l3gd20h

/// @file
/// Truncation of the samples of a gyro toward zero, undone.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "core/base/units.hpp"

namespace zerorate::core {

/// Undoes a chip or a library that cuts rates toward zero instead of rounding them: the middle of
/// the rates that are read as k steps lies half a step farther from zero. A reading of zero stands
/// for rates from -1 to 1 step and stays.
///
/// Cost of a sample: three additions where it is on.
struct Truncation {
  using Rates = std::array<AngularRate, 3>;

  float half_step_rad_s = 0.0F;  ///< half a level of the output; 0: the samples are rounded

  constexpr bool operator==(const Truncation&) const = default;
  /// Test of the bits, because a processor without floating point asks at every sample.
  [[nodiscard]] constexpr bool is_on() const {
    return std::bit_cast<std::uint32_t>(half_step_rad_s) != 0;
  }
  /// Rate before it was cut, as far as it is known.
  [[nodiscard]] constexpr AngularRate undone(AngularRate measured) const {
    const float rate_rad_s = measured.in(rad_per_s);
    if (rate_rad_s > 0.0F) return rad_per_s(rate_rad_s + half_step_rad_s);
    if (rate_rad_s < 0.0F) return rad_per_s(rate_rad_s - half_step_rad_s);
    return measured;
  }
  [[nodiscard]] constexpr Rates undone(Rates measured) const {
    for (AngularRate& rate : measured) rate = undone(rate);
    return measured;
  }
};

}  // namespace zerorate::core

/// @file
/// From physical values to the counts and bytes of a chip.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/units.hpp"

namespace zerorate::hal::sim {

/// In double precision, so that a count at the edge between two is decided by the value.
[[nodiscard]] inline double in_deg_per_s(core::AngularRate rate) {
  return static_cast<double>(rate.in(core::rad_per_s)) * 180.0 / std::numbers::pi;
}

/// Rounds to the nearest count and clips.
[[nodiscard]] inline std::int16_t to_counts(double counts, double lowest = -32768.0,
                                            double highest = 32767.0) {
  return static_cast<std::int16_t>(std::clamp(std::round(counts), lowest, highest));
}

[[nodiscard]] inline std::uint8_t low_byte(std::int16_t value) {
  return static_cast<std::uint8_t>(static_cast<std::uint16_t>(value) & 0xFFU);
}
[[nodiscard]] inline std::uint8_t high_byte(std::int16_t value) {
  return static_cast<std::uint8_t>(static_cast<std::uint16_t>(value) >> 8U);
}

/// Error of a gyro's rate while it starts: falls linearly from 20 deg/s to 0. The size is of
/// our choosing, large enough to be noticed if it is let through.
[[nodiscard]] inline double start_up_transient_dps(core::Duration age,
                                                   core::Duration turn_on_time) {
  constexpr double kTransientDps = 20.0;
  if (age >= turn_on_time) return 0.0;
  return kTransientDps *
         (1.0 - static_cast<double>(age.ns()) / static_cast<double>(turn_on_time.ns()));
}

}  // namespace zerorate::hal::sim

/// @file
/// Conversion of angles and rates between SI and the units that people read.
#pragma once

#include <cstdint>
#include <numbers>

namespace zerorate::units {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;
/// deg/h in rad/s.
inline constexpr double kDphPerRadS = 3600.0 * kDegPerRad;
/// rad/s in deg/h.
inline constexpr double kRadSPerDph = kRadPerDeg / 3600.0;
/// deg/sqrt(h) in rad/sqrt(s).
inline constexpr double kDegRtHPerRadRtS = 60.0 * kDegPerRad;

/// Nanoseconds in seconds.
[[nodiscard]] constexpr double seconds(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

}  // namespace zerorate::units

/// @file
/// Conversion of angles and rates between SI and the units that people read.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <numbers>
#include <string>

namespace zerorate::units {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr double kDegPerRad = 180.0 / std::numbers::pi;
/// deg/h in rad/s.
inline constexpr double kDphPerRadS = 3600.0 * kDegPerRad;
/// rad/s in deg/h.
inline constexpr double kRadSPerDph = kRadPerDeg / 3600.0;
/// deg/sqrt(h) in rad/sqrt(s).
inline constexpr double kDegRtHPerRadRtS = 60.0 * kDegPerRad;
/// rad/s/sqrt(s) in deg/h/sqrt(h).
inline constexpr double kDphRtHPerRadSRtS = 60.0 * kDphPerRadS;

/// Standard gravity (3rd CGPM, 1901).
inline constexpr double kGravity_m_s2 = 9.80665;

/// Nanoseconds in seconds.
[[nodiscard]] constexpr double seconds(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

/// A number as people write it, to three digits: "0.0412", "1150", not "1.15e+03".
[[nodiscard]] inline std::string in_figures(double value, int digits = 3) {
  std::string text = fmt::format("{:.{}g}", value, digits);
  return text.find("e+0") == std::string::npos ? text : fmt::format("{:.0f}", std::stod(text));
}

}  // namespace zerorate::units

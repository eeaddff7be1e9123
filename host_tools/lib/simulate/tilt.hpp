/// @file
/// Axes that do not stand upright: a body on a slope, and a gyro that is mounted askew.
#pragma once

#include <array>
#include <cmath>

namespace zerorate::simulate {

/// Angles by which axes x (forwards), y (left) and z (up) are tilted: first about y, then about the
/// new x.
struct Tilt {
  double roll_rad = 0.0;   ///< about x; positive: the left side rises
  double pitch_rad = 0.0;  ///< about y; positive: the nose sinks

  constexpr bool operator==(const Tilt&) const = default;
};

/// A vector of upright axes, as the tilted ones measure it. Without a tilt it has the same bits.
[[nodiscard]] inline std::array<double, 3> seen_by(const Tilt& tilt,
                                                   const std::array<double, 3>& upright) {
  const double sin_pitch = std::sin(tilt.pitch_rad);
  const double cos_pitch = std::cos(tilt.pitch_rad);
  const double sin_roll = std::sin(tilt.roll_rad);
  const double cos_roll = std::cos(tilt.roll_rad);
  const auto [x, y, z] = upright;
  const double z_pitched = sin_pitch * x + cos_pitch * z;
  return {cos_pitch * x - sin_pitch * z, cos_roll * y + sin_roll * z_pitched,
          cos_roll * z_pitched - sin_roll * y};
}

}  // namespace zerorate::simulate

/// @file
/// Angles by which a sensor leans.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/earth_rate.hpp"
#include "core/base/numeric.hpp"
#include "core/base/units.hpp"

namespace zerorate::core {

/// Angle of the vector (x, y) from the first axis, from -180 to 180 deg. Error below 1e-6 rad.
/// Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49, in the octant of the vector.
[[nodiscard]] constexpr Angle angle_of(float y, float x) {
  constexpr std::array<float, 8> kOdd{-0.3333314528F, 0.1999355085F, -0.1420889944F, 0.1065626393F,
                                      -0.0752896400F, 0.0429096138F, -0.0161657367F, 0.0028662257F};
  const float across = y < 0.0F ? -y : y;
  const float along = x < 0.0F ? -x : x;
  const bool is_steep = across > along;
  const float longer = is_steep ? across : along;
  if (!(longer > 0.0F)) return {};
  const float ratio = (is_steep ? along : across) / longer;
  float series = 0.0F;
  for (std::size_t i = kOdd.size(); i > 0; --i) series = (series + kOdd[i - 1]) * ratio * ratio;
  float angle_rad = ratio * (1.0F + series);
  if (is_steep) angle_rad = deg(90.0F).in(rad)-angle_rad;
  if (x < 0.0F) angle_rad = deg(180.0F).in(rad)-angle_rad;
  return rad(y < 0.0F ? -angle_rad : angle_rad);
}

/// Attitude of a sensor. A level one has its z axis up, and all angles zero. Roll turns it about x,
/// pitch about y, right-handed; a heading does not show.
struct Attitude {
  Angle roll;   ///< from -180 to 180 deg
  Angle pitch;  ///< from -90 to 90 deg
  Angle tilt;   ///< between the z axis and the vertical, from 0 to 180 deg
};

/// @param up need not have the length 1
[[nodiscard]] constexpr Attitude attitude_of(const Direction& up) {
  const auto [x, y, z] = up;
  return {.roll = angle_of(y, z),
          .pitch = angle_of(0.0F - x, square_root(y * y + z * z)),
          .tilt = angle_of(square_root(x * x + y * y), z)};
}

}  // namespace zerorate::core

/// @file
/// Directions in which the attitudes of a record differ.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "host_tools/lib/diagnose/inputs/input_regression.hpp"
#include "host_tools/lib/diagnose/record/input_ticks.hpp"

namespace zerorate::diagnose {

using Direction = std::array<double, 3>;  ///< unit vector in sensor axes

/// Directions in which the acceleration of the standstills differs.
struct Attitudes {
  std::vector<Direction> directions;  ///< at right angles, the one of most change first
  std::size_t standstills = 0;
};

/// Directions along which the mean accelerations of the standstills scatter by at least
/// kLeastSpread_g: along the others a sensitivity and a constant bias are one.
[[nodiscard]] Attitudes attitudes_of(const InputTicks& ticks);
inline constexpr double kLeastSpread_g = 0.1;  ///< rms; some 6 deg of tilt each way

/// The acceleration along a direction, in g.
[[nodiscard]] InputColumn acceleration_along(const InputTicks& ticks, const Direction& direction);

}  // namespace zerorate::diagnose

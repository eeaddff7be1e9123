/// @file
/// White noise of the measured rate (angle random walk): no state, the variance of a measurement.
#pragma once

#include "core/base/time.hpp"

namespace zerorate::core {

struct White {
  float angle_random_walk_rad_sqrt_s = 0.0F;  ///< N of IEEE Std 952 [rad/s/sqrt(Hz) = rad/sqrt(s)]

  /// Variance of the mean over an averaging time [rad2/s2].
  [[nodiscard]] constexpr float variance(Duration averaging_time) const {
    return angle_random_walk_rad_sqrt_s * angle_random_walk_rad_sqrt_s /
           averaging_time.in_seconds();
  }
};

}  // namespace zerorate::core

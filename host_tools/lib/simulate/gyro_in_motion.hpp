/// @file
/// Errors of a gyro that rest does not show.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "host_tools/lib/simulate/tilt.hpp"

namespace zerorate::simulate {

/// Errors of a gyro in motion, axis by axis; none by default.
struct MotionErrors {
  /// Speed at which the offset of the bias is that of `offset_rad_s`.
  static constexpr double kOffsetSpeed_m_s = 10.0;

  std::array<double, 3> scale_factor{};  ///< 0.01: each rate is measured 1 % too large
  /// Half the difference between the scale factors of both senses; 0.01: a positive rate is
  /// measured 1 % too large, a negative one 1 % too small.
  std::array<double, 3> asymmetry{};
  Tilt mounting{};  ///< tilt of the gyro's axes against those of the vehicle
  /// Difference between the bias at kOffsetSpeed_m_s and that at rest [rad/s]. Vibration makes it
  /// (rectification), and grows with the speed: the offset is in proportion to it.
  std::array<double, 3> offset_rad_s{};

  /// Rates of the vehicle as the gyro's axes measure them, without bias and noise [rad/s].
  [[nodiscard]] std::array<double, 3> measured(const std::array<double, 3>& rate_rad_s) const {
    std::array<double, 3> measured = seen_by(mounting, rate_rad_s);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double sense = std::copysign(1.0, measured[axis]);
      measured[axis] *= 1.0 + scale_factor[axis] + sense * asymmetry[axis];
    }
    return measured;
  }
  /// Offset of an axis' bias at a speed [rad/s].
  [[nodiscard]] double offset(std::size_t axis, double speed_m_s) const {
    return offset_rad_s[axis] * speed_m_s / kOffsetSpeed_m_s;
  }
};

}  // namespace zerorate::simulate

/// @file
/// One reading of a gyro.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/units.hpp"

namespace zerorate::core {

/// Rates, temperature and acceleration that a chip measured at one time.
struct GyroSample {
  Instant time;  ///< on the node's monotonic clock
  /// x, y, z of the chip; raw 0 is exactly 0. A chip with one axis gives its rate on all three, so
  /// that no axis shows zero noise.
  std::array<AngularRate, 3> rate;
  Temperature temperature;  ///< valid only if has_temperature
  bool has_temperature = false;
  bool has_acceleration = false;
  std::uint8_t saturated_axes = 0;  ///< bit i: axis i of the gyro is at or beyond full scale
  /// Specific force along x, y, z of the chip, which at rest is 1 g upwards; valid only if
  /// has_acceleration. An axis at the end of its range makes it invalid.
  std::array<Acceleration, 3> acceleration;
};

}  // namespace zerorate::core

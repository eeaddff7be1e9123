/// @file
/// A road vehicle between stops: how it turns, and what its odometer counts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::simulate {

/// Exponentially distributed stops and drives around these means; begins with a stop.
struct VehicleParams {
  double duration_s = 3600.0;
  double mean_stop_s = 60.0;
  double mean_drive_s = 180.0;
  double cruise_speed_m_s = 14.0;  ///< each drive's own lies within 40 % of it
  double metres_per_pulse = 0.05;
  double peak_turn_rad_s = 0.4;  ///< of the sharpest turns
};

/// Motion of the vehicle, sample by sample.
struct VehicleMotion {
  double sample_period_s = 0.0;
  std::vector<std::array<double, 3>> rate_rad_s;  ///< true rate about x (roll), y (pitch), z (yaw)
  std::vector<double> speed_m_s;                  ///< magnitude
  std::vector<std::int64_t> odometer_pulses;      ///< cumulative

  [[nodiscard]] std::size_t size() const { return odometer_pulses.size(); }
};

/// Drives accelerate, cruise with turns and brake; the body rocks for about a second after each
/// stop, which is why a node waits for a settle time.
[[nodiscard]] VehicleMotion simulate_vehicle(const VehicleParams& params, double sample_period_s,
                                             const random::RandomStream& stream);

}  // namespace zerorate::simulate

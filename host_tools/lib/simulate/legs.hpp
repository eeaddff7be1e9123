/// @file
/// A drive written down leg by leg, where what happens when matters.
#pragma once

#include <span>

#include "host_tools/lib/simulate/vehicle.hpp"

namespace zerorate::simulate {

/// A stretch at one speed and one yaw rate, to which both change from those of the leg before.
struct Leg {
  double length_s = 0.0;
  double speed_m_s = 0.0;
  double turn_dps = 0.0;
  double ramp_s = 1.0;  ///< time of that change, from the leg's beginning
};

/// The body leans and nods as that of simulate_vehicle(); it does not rock after braking.
[[nodiscard]] VehicleMotion follow(std::span<const Leg> legs, double sample_period_s,
                                   double metres_per_pulse = 0.05);

}  // namespace zerorate::simulate

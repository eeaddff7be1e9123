/// @file
/// The gyro of a scenario: it makes a recording of a vehicle's motion.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "host_tools/lib/simulate/scenario.hpp"
#include "host_tools/lib/simulate/simulate.hpp"
#include "host_tools/lib/simulate/vehicle.hpp"

namespace zerorate::simulate {

inline constexpr double kScenarioPeriod_s = 1.0 / 104.0;

/// Particulars of the gyro of a scenario.
struct ScenarioGyro {
  std::array<double, 3> bias_dps{0.3, -0.2, 0.1};
  double arw_dps_rt_s = kScenarioArwDpsRtS;
  double bias_instability_dph = kScenarioBiasInstabilityDph;
  std::vector<Effect> drift{};                       ///< of the bias about z
  std::vector<Effect> disturbance{};                 ///< of what is measured about every axis
  std::function<double(double)> temperature_degc{};  ///< at a time in seconds; none: no thermometer
};

/// The gyro on the vehicle, its odometer, and the motion's own heading, rate and speed as
/// reference.
[[nodiscard]] ScenarioDrive record(const VehicleMotion& motion, const ScenarioGyro& gyro,
                                   std::uint64_t seed);

}  // namespace zerorate::simulate

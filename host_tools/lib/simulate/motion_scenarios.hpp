/// @file
/// Scenarios of a gyro whose errors show in motion alone, with references of the heading.
#pragma once

#include <cstdint>

#include "host_tools/lib/simulate/scenario.hpp"

namespace zerorate::simulate {

/// Half an hour in streets with a scale factor that is 1 % too large; exact headings.
[[nodiscard]] ScenarioDrive scale_1_percent(std::uint64_t seed);
/// Half an hour in the same streets with a gyro that is tilted by 5 deg; two antennas.
[[nodiscard]] ScenarioDrive mounted_askew(std::uint64_t seed);
/// An hour at 33 m/s between two stops, with bends, tunnels and a bias that is another in motion; a
/// course each second.
[[nodiscard]] ScenarioDrive motorway_hour(std::uint64_t seed);
/// Streets, ramps and tight turns of a car park, streets again; a course in the streets only.
[[nodiscard]] ScenarioDrive car_park(std::uint64_t seed);
/// Asymmetry of the robot's gyro about z.
inline constexpr double kRobotAsymmetry = 0.002;
/// A robot that spins on the spot to both sides, with a scale factor that is 1 % too large and an
/// asymmetry; a mark at each stop. Its speed is that of its wheels.
[[nodiscard]] ScenarioDrive spinning_robot(std::uint64_t seed);

}  // namespace zerorate::simulate

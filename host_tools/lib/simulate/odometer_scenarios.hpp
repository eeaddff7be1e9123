/// @file
/// Scenarios of a car in traffic, whose odometer says zero while it still rolls.
#pragma once

#include <cstdint>

#include "host_tools/lib/simulate/scenario.hpp"

namespace zerorate::simulate {

/// Half an hour in town with the odometer of a car.
[[nodiscard]] ScenarioDrive dead_band(std::uint64_t seed);
/// In queues: several moves forward within a stop, some of them in a bend.
[[nodiscard]] ScenarioDrive inching(std::uint64_t seed);
/// Manoeuvres: each creep turns as tightly as a car can.
[[nodiscard]] ScenarioDrive parking_turn(std::uint64_t seed);
/// The drive of dead_band(), with a speed message once a second.
[[nodiscard]] ScenarioDrive speed_by_can(std::uint64_t seed);

}  // namespace zerorate::simulate

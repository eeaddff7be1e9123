/// @file
/// Events that reach a node from outside, written down so that an emulated board and a replay on a
/// PC see the same.
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <vector>

namespace zerorate::emulated {

/// One line of a scenario file: `p TIME_US`, a rising edge of the odometer, or
/// `s TIME_US X Y Z T`, a conversion of the gyro: raw rates and raw temperature. Times increase.
struct Event {
  std::int64_t time_us = 0;
  bool is_pulse = false;
  std::array<std::int16_t, 3> rate{};
  std::int16_t temperature = 0;
};
using Scenario = std::vector<Event>;

/// Throws std::runtime_error with the number of a line that is none.
[[nodiscard]] Scenario read_scenario(std::istream& in);
void write_scenario(const Scenario& scenario, std::ostream& out);

/// An LSM6DSO at 104 Hz in a vehicle with several stops: noise of its model, a warming up, turns,
/// and odometer pulses up to nearly 500 Hz. The same for the same duration and seed.
[[nodiscard]] Scenario make_drive(double duration_s, std::uint64_t seed);

}  // namespace zerorate::emulated

/// @file
/// A driver in traffic: pulls away, drives, brakes to a stop, inches forward in a queue, and turns
/// while creeping.
#pragma once

#include <vector>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/legs.hpp"

namespace zerorate::simulate {

/// Habits of a driver; those of docs/reference/real-odometers.md by default. Lengths of stops and
/// drives are exponential around their means, all other figures uniform within 40 % of theirs.
struct DriverParams {
  double duration_s = 1800.0;
  double mean_stop_s = 14.0;
  double mean_drive_s = 50.0;
  double cruise_speed_m_s = 9.0;
  double pulls_away_with_m_s2 = 0.9;
  double brakes_with_m_s2 = 0.9;
  double creep_speed_m_s = 0.45;  ///< while creeping or inching
  double creep_s = 2.0;           ///< length of each creep
  /// Share of the stops that begin with a creep, and of those that end with one.
  double creeping_share = 0.15;
  double inches_per_stop = 0.2;  ///< mean number of moves forward within a stop
  /// Radii of the bends in which it creeps and pulls away, to either side: their logarithms are
  /// uniform between those of these two.
  double tightest_bend_m = 20.0;
  double widest_bend_m = 8000.0;
};

/// Legs of a drive that begins with a stop of half a minute and ends at rest.
[[nodiscard]] std::vector<Leg> drive_in_traffic(const DriverParams& params,
                                                const random::RandomStream& stream);

}  // namespace zerorate::simulate

/// @file
/// Sources of the heading beside a gyro, with their errors: the course of a GNSS receiver, two
/// antennas, and a mark on the floor.
#pragma once

#include <span>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::simulate {

/// A heading as a source gives it.
struct SensedHeading {
  double time_s = 0.0;       ///< when it is given
  double heading_rad = 0.0;  ///< counter-clockwise; not wrapped
  double sigma_rad = 0.0;    ///< standard deviation that the source states
};

/// True heading and speed of a vehicle at equal intervals, both as long.
struct TrueCourse {
  double period_s = 0.0;
  std::span<const double> heading_rad;  ///< whole turns included
  std::span<const double> speed_m_s;
};

/// Times without a signal: lengths and distances are exponential around their means.
struct Outages {
  double mean_between_s = 0.0;  ///< 0: there are none
  double mean_length_s = 20.0;
};

/// Reflections: the heading jumps by a normal angle, and comes back exponentially.
struct Multipath {
  double mean_between_s = 0.0;  ///< 0: there are none
  double jump_sigma_rad = 0.2;
  double decay_s = 5.0;
};

/// Course over ground of a GNSS receiver. The stated deviation is that of its noise: delay and
/// reflections are not in it.
struct GnssCourse {
  double rate_hz = 1.0;
  double least_speed_m_s = 5.0;  ///< below it, there is no course
  /// Deviation at 10 m/s. That of the velocity does not depend on the speed, so that of the course
  /// is in inverse proportion to it.
  double sigma_at_10_m_s_rad = 0.012;
  double delay_s = 0.2;  ///< age of the heading when it is given
  Outages outages{};
  Multipath multipath{};

  [[nodiscard]] std::vector<SensedHeading> sense(const TrueCourse& truth,
                                                 const random::RandomStream& stream) const;
};

/// Two antennas on the roof: a heading at rest, too.
struct TwoAntennas {
  double rate_hz = 5.0;
  double baseline_m = 1.0;
  double position_sigma_m = 0.005;  ///< across the baseline, of one antenna against the other
  Outages outages{};

  [[nodiscard]] std::vector<SensedHeading> sense(const TrueCourse& truth,
                                                 const random::RandomStream& stream) const;
};

/// A mark on the floor or a wall, against which the vehicle stops: one heading in each stop.
struct Mark {
  double sigma_rad = 0.005;
  double after_s = 4.0;  ///< time of rest before it is read; a shorter stop gives none

  [[nodiscard]] std::vector<SensedHeading> sense(const TrueCourse& truth,
                                                 const random::RandomStream& stream) const;
};

}  // namespace zerorate::simulate

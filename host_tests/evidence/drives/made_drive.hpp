/// @file
/// Drives like those of a car with a MEMS gyro, made of recordings: the speed and the speed signal
/// of one, the turning of another, the noise of a third.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace zerorate::drives {

using Axes = std::array<double, 3>;

/// Motion of a vehicle at equal intervals, without any noise.
struct Motion {
  std::string name;
  double period_s = 0.1;
  std::vector<double> speed_mps;
  std::vector<double> odometer_pulses;  ///< counted from the speed signal, dead band included
  std::vector<Axes> rate_dps;
};

/// Readings of a gyro at rest at equal intervals.
struct Rest {
  std::string name;
  double period_s = 0.1;
  std::vector<Axes> rate_dps;
};

/// Input of a node, and the truth about it.
struct Drive {
  std::string name;
  double period_s = 0.1;
  std::vector<double> speed_mps;
  std::vector<double> odometer_pulses;
  std::vector<Axes> measured_dps;
  std::vector<Axes> force_g;        ///< readings of an accelerometer; empty: there is none
  std::vector<double> heading_deg;  ///< integral of the true rate about z
};

/// Motions with recorded speeds: the drive whose turning was measured by a ring-laser gyro as it
/// was, and two others that turn where it turned, by distance.
/// @param seed of how the wheels stand while the vehicle rolls out and inches forward
[[nodiscard]] std::vector<Motion> recorded_motions(const std::filesystem::path& recordings,
                                                   std::uint64_t seed);

/// The drive of the ring-laser gyro as recorded, with the heading of its reference.
[[nodiscard]] Drive ring_laser_drive(const std::filesystem::path& recordings);

/// ADIS16405, 10 Hz means, `scale` times as large.
[[nodiscard]] Rest adis16405_rest(const std::filesystem::path& recordings, int run, double scale);
/// The thermal sweep, of whose slow drift by 90 K a hundredth is left: an hour of a car.
[[nodiscard]] Rest thermal_sweep_rest(const std::filesystem::path& recordings);

/// The motion at the rest's interval, by a gyro whose scale is 0.3 % off, with the noise from a
/// place of the rest and with its axes in an order that the seed chooses.
[[nodiscard]] Drive make_drive(const Motion& motion, const Rest& rest, std::uint64_t seed);

}  // namespace zerorate::drives

/// @file
/// A road vehicle between stops: how it turns, and what its odometer counts; a driver in traffic,
/// who pulls away, drives, brakes to a stop, inches forward in a queue, and turns while creeping;
/// odometers with a dead band, and those whose speed comes in messages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
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
  double peak_turn_rad_s = 0.4;  ///< rate in the sharpest turns
};

/// Motion of the vehicle, sample by sample.
struct VehicleMotion {
  double sample_period_s = 0.0;
  /// True rate about the body's x (roll), y (pitch), z (yaw).
  std::vector<std::array<double, 3>> rate_rad_s{};
  std::vector<double> turn_rad_s{};             ///< rate of the heading: about the vertical
  std::vector<double> speed_m_s{};              ///< magnitude
  std::vector<std::int64_t> odometer_pulses{};  ///< cumulative
  /// Specific force along the body's axes [g]; empty: not known.
  std::vector<std::array<double, 3>> force_g{};

  [[nodiscard]] std::size_t size() const { return odometer_pulses.size(); }
};

/// Drives accelerate, cruise with turns and brake; the body rocks for about a second after each
/// stop, which is why a node waits for a settle time.
[[nodiscard]] VehicleMotion simulate_vehicle(const VehicleParams& params, double sample_period_s,
                                             const random::RandomStream& stream);

/// A stretch at one speed, yaw rate and slope, to which all change from those of the leg before.
struct Leg {
  double length_s = 0.0;
  double speed_m_s = 0.0;
  double turn_dps = 0.0;  ///< about the vertical
  double ramp_s = 1.0;    ///< time of that change, from the leg's beginning
  double grade = 0.0;     ///< rise of the road per distance; 0.05: 5 % uphill
  double bank = 0.0;      ///< rise of its left side per width
};

/// The body nods as that of simulate_vehicle(), and leans outwards in a curve by 5 deg per g; it
/// does not rock after braking. Tilted axes share the turn about the vertical, and its forces.
[[nodiscard]] VehicleMotion follow(std::span<const Leg> legs, double sample_period_s,
                                   double metres_per_pulse = 0.05);

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

/// Physical figures of an odometer; those of an ideal one by default.
struct OdometerParams {
  double metres_per_pulse = 0.05;
  double leaves_zero_at_m_s = 0.0;  ///< speed above which a silent odometer begins to count
  double silent_below_m_s = 0.0;    ///< at most leaves_zero_at_m_s: the difference is hysteresis
  /// Time below silent_below_m_s after which the odometer falls silent; until then it shows at
  /// least leaves_zero_at_m_s.
  double holds_s = 0.0;
  double latency_s = 0.0;        ///< from the wheel to the message or pulse
  double message_rate_hz = 0.0;  ///< 0: no messages, the wheel's own pulses
  double step_m_s = 0.0;         ///< rounding step of the speed; 0: not rounded
};

/// Speed signal of a car: the figures of docs/reference/real-odometers.md.
[[nodiscard]] OdometerParams car_odometer();

/// Speed that the odometer shows at each sample [m/s].
/// @param speed_m_s  true magnitudes; the vehicle stood before the first
/// Throws std::invalid_argument for parameters that no odometer can have.
[[nodiscard]] std::vector<double> shown_speed(std::span<const double> speed_m_s,
                                              double sample_period_s, const OdometerParams& params);

/// Pulses counted up to each sample, at the pace of shown_speed(). Throws as shown_speed().
[[nodiscard]] std::vector<std::int64_t> count_pulses(std::span<const double> speed_m_s,
                                                     double sample_period_s,
                                                     const OdometerParams& params);

}  // namespace zerorate::simulate

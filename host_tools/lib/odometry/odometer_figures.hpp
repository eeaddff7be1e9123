/// @file
/// Figures of a real odometer, measured against a reference's speed, and the stretches in which it
/// reads zero although the vehicle rolls.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/odometry/speed_record.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::odometry {

using statistics::BootstrapFigure;

/// Values in increasing order, and their median with its 95 % interval.
struct Sample {
  std::vector<double> sorted;
  BootstrapFigure median;
};

/// Situation of a vehicle that rolls while its odometer reads zero.
enum class Situation {
  before_stop,  ///< last metres, the odometer is already silent
  after_stop,   ///< first metres, the odometer is still silent
  inching,      ///< between two moments of standing
  passing       ///< without standing while the odometer is silent
};
inline constexpr std::array kSituations{Situation::before_stop, Situation::after_stop,
                                        Situation::inching, Situation::passing};
[[nodiscard]] std::string_view name(Situation situation);

/// Rolling at zero, all of it or in one situation.
struct Rolling {
  std::size_t rows = 0;
  BootstrapFigure share;              ///< share of the rows at zero
  std::vector<double> speeds_m_s;     ///< in increasing order
  std::vector<double> turning_rad_s;  ///< magnitudes, in increasing order; empty without yaw rates
};

struct OdometerFigures {
  double rows_s = 0.0;  ///< time between rows
  double duration_s = 0.0;
  double silent_share = 0.0;  ///< share of the rows with the odometer at zero

  /// Smallest speed but zero in two rows next to each other [m/s]; none of a pulse odometer.
  std::optional<double> smallest_m_s;
  std::optional<double> step_m_s;  ///< step of the speeds; none of a pulse odometer
  Sample renewal_s;  ///< between changes of the odometer's speed while the vehicle brakes hard
  BootstrapFigure latency_s;
  BootstrapFigure scale;    ///< odometer over reference; of pulses 1 by definition
  Sample leaves_zero_m_s;   ///< speed of the reference as the odometer leaves zero
  Sample reaches_zero_m_s;  ///< speed where it reaches zero
  /// From the reference's last speed of at least `smallest_m_s` until the odometer is zero.
  Sample holds_s;

  Rolling rolling;
  std::array<Rolling, kSituations.size()> rolling_by_situation;
  std::vector<double> standing_turning_rad_s;  ///< at true rest, to compare with; sorted

  Sample true_stops_s;
  Sample odometer_stops_s;
  Sample true_drives_s;
  Sample odometer_drives_s;
  std::vector<double> accelerations_m_s2;  ///< accelerations over a second, above 1 m/s; sorted
  Sample braking_m_s2;       ///< deceleration over the last two seconds before a true stop
  Sample pulling_away_m_s2;  ///< acceleration over the first two seconds after it
};

/// Intervals are at 95 %, by drawing stretches at zero (or minutes) again, with a fixed seed.
[[nodiscard]] OdometerFigures measure_odometer(const SpeedRecord& record);

/// Time by which the odometer's speed is late [s], positive if late: least mean square difference
/// to the reference while both exceed 2 m/s, within one second; intervals from minutes drawn again.
[[nodiscard]] BootstrapFigure measure_latency(const SpeedRecord& record);

/// Ends with a line end.
[[nodiscard]] std::string to_json(const SpeedRecord& record, const OdometerFigures& figures);

/// Row in which the vehicle rolls although its odometer reads zero.
struct RollingRow {
  std::size_t row;
  Situation situation;
};

struct Silence {
  Stretch rows;
  std::vector<RollingRow> rolling;
};

[[nodiscard]] std::vector<Silence> find_silences(const SpeedRecord& record);

/// @param situation  none: all of them
[[nodiscard]] Rolling describe_rolling(const SpeedRecord& record,
                                       const std::vector<Silence>& silences,
                                       std::optional<Situation> situation);

}  // namespace zerorate::odometry

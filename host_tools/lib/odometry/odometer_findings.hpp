/// @file
/// Faults of an odometer by name, judged against a reference's speed.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/odometry/odometer_figures.hpp"
#include "host_tools/lib/odometry/speed_record.hpp"

namespace zerorate::odometry {

/// A figure of a finding, the unit at the end of its name, with its 95 % interval.
struct FindingFigure {
  std::string name;
  BootstrapFigure figure;  ///< without an interval: a count, or an extreme value
};

struct OdometerFinding {
  /// `motion_in_stops`, `odometer_dead_band`, `odometer_late`, `odometer_double_counting` or
  /// `odometer_silent`.
  std::string name;
  std::string sentence;  ///< for a firmware engineer
  std::vector<FindingFigure> figures;
};

/// Heading errors of the drives between true stops, with the bias learnt from every stop by the
/// odometer, and from the calm in the stops as the findings advise.
struct HeadingGain {
  std::size_t drives = 0;
  double every_stop_rms_rad = 0.0;
  double every_stop_coverage95 = 0.0;
  double calm_rms_rad = 0.0;
  double calm_coverage95 = 0.0;
};

/// Result for an odometer.
struct OdometerDiagnosis {
  std::vector<OdometerFinding> findings;  ///< empty for a healthy one
  std::string configuration;              ///< lines for zerorated's file; may be empty
  std::optional<HeadingGain> gain;        ///< where there is motion in stops, and a true heading

  [[nodiscard]] const OdometerFinding* find(std::string_view name) const;
};

/// Lines of the table [odometer] for a node with these findings.
[[nodiscard]] std::string configuration_of(const SpeedRecord& record,
                                           const std::vector<OdometerFinding>& findings);

/// Looks for five faults of an odometer; empty for a healthy one. A fault is reported where the
/// lower end of the 95 % interval of its figure lies beyond what a healthy odometer shows:
///
/// - motion_in_stops: metres rolled in a silence, beyond a pulse at each end, above 0.02 on
///   average;
/// - odometer_dead_band: speed at which the odometer leaves zero, less what its latency explains,
///   above what a vehicle gathers before the first pulse; or metres rolled before the stop alone,
///   where a late odometer is silent too late;
/// - odometer_late: latency above 0.1 s and above a row;
/// - odometer_double_counting: spans of 10 s above 2 m/s with 1.5 times the usual pulses a metre;
/// - odometer_silent: silence for 2 s and more above 2 m/s.
[[nodiscard]] std::vector<OdometerFinding> find_odometer_faults(const SpeedRecord& record,
                                                                const OdometerFigures& figures);

}  // namespace zerorate::odometry

/// @file
/// Comparison of predictors over the same drives of several recordings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "host_tools/lib/evaluate/drive_scores.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::contest {

using statistics::BootstrapFigure;

/// One contestant under one schedule, or under all of them. The bootstrap draws recording-axes, not
/// drives, because the drives of one axis share its fit and its weather.
struct DriveStanding {
  /// Root mean square of the heading drift over that of the calibration mean: geometric mean over
  /// recording-axes (and schedules).
  BootstrapFigure ratio;
  BootstrapFigure coverage;     ///< share of the drives inside the 95 % interval; NaN without one
  double sigma_over_rms = 0.0;  ///< see evaluate::DriveScores; NaN without an interval
  double drift_rms_deg = 0.0;   ///< rms over all drives
};

/// Sums over drives of one axis, addable.
struct DriveSums {
  double drives = 0.0;
  double squares_rad2 = 0.0;
  double covered = 0.0;  ///< NaN without an interval
  double sigma_rad = 0.0;

  DriveSums& operator+=(const DriveSums& other) {
    drives += other.drives;
    squares_rad2 += other.squares_rad2;
    covered += other.covered;
    sigma_rad += other.sigma_rad;
    return *this;
  }
  DriveSums operator/(double count) const {
    return {drives / count, squares_rad2 / count, covered / count, sigma_rad / count};
  }
};

[[nodiscard]] DriveSums sums_of(const evaluate::DriveScores& scores);

/// One contestant's sums by recording-axis and schedule.
using DriveResults = std::vector<std::vector<DriveSums>>;

/// Schedules of a standing: first, and one past the last.
struct ScheduleRange {
  std::size_t first;
  std::size_t last;
};

/// Standings against one yardstick.
class Standings {
 public:
  /// @param yardstick  results of the contestant that all are compared with, of the same shape
  /// @param seed  of the bootstrap
  Standings(DriveResults yardstick, std::uint64_t seed)
      : yardstick_(std::move(yardstick)), seed_(seed) {}

  /// Cost: 2000 sums over the recording-axes and schedules.
  [[nodiscard]] DriveStanding standing(const DriveResults& own, ScheduleRange range) const;
  /// Ratio of the drifts of any two contestants, as DriveStanding::ratio.
  [[nodiscard]] BootstrapFigure ratio(const DriveResults& own, const DriveResults& other,
                                      ScheduleRange range) const;
  /// Drives of the yardstick.
  [[nodiscard]] double drives(ScheduleRange range) const;

 private:
  [[nodiscard]] BootstrapFigure over_clusters(const statistics::Statistic& statistic) const;

  DriveResults yardstick_;
  std::uint64_t seed_;
};

}  // namespace zerorate::contest

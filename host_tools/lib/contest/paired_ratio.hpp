/// @file
/// Errors of two predictors on the same stops or drives, and what the turns of drives show.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::contest {

/// Squared errors of two contestants that stand in pairs, each log a part.
using SquarePairs = std::vector<std::vector<std::array<double, 2>>>;

/// Root mean square of the first over that of the second, with its 95 % interval: whole logs are
/// drawn with replacement, or single pairs where there are fewer than
/// evaluate::kFewestDrivesOfARatio logs. NaN with fewer pairs than that.
[[nodiscard]] statistics::BootstrapFigure paired_ratio(const SquarePairs& logs);

/// A drive against a reference.
struct Turn {
  double turn_rad = 0.0;   ///< turn of the reference
  double drift_rad = 0.0;  ///< turn of the gyro less that of the reference
};

/// An error of the scale factor as turns show it.
struct ScaleInTurns {
  double error = 0.0;  ///< 0.01: the sensor measures 1 % too much
  double sigma = 0.0;
  /// Heading error with it taken off, over that without; each drive by the error of all others.
  statistics::BootstrapFigure ratio;
};

/// Least squares of the drifts over the turns; nullopt where nothing turns, or with fewer than
/// evaluate::kFewestDrivesOfARatio drives.
[[nodiscard]] std::optional<ScaleInTurns> scale_in_turns(
    const std::vector<std::vector<Turn>>& logs);

}  // namespace zerorate::contest

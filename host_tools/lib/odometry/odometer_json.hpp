/// @file
/// Figures of an odometer as JSON; docs/reference/odometer-json.md describes it.
#pragma once

#include <string>

#include "host_tools/lib/odometry/odometer_figures.hpp"

namespace zerorate::odometry {

/// Ends with a line end.
[[nodiscard]] std::string to_json(const SpeedRecord& record, const OdometerFigures& figures);

}  // namespace zerorate::odometry

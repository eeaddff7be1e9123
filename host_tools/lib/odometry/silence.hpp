/// @file
/// Stretches in which an odometer says zero, and how the vehicle rolls in them.
#pragma once

#include <array>
#include <vector>

#include "host_tools/lib/odometry/odometer_figures.hpp"

namespace zerorate::odometry {

/// Row in which the vehicle rolls although its odometer says zero.
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

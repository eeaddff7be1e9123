/// @file
/// Strength of white noise by the changes between neighbours.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::statistics {

/// Standard deviation of normal white noise by the sizes of changes between neighbours.
[[nodiscard]] inline double sigma_by_median(std::vector<double> changes) {
  constexpr double kMedianPerSigma = 0.6744897501960817;
  return median_of(std::move(changes)) / (kMedianPerSigma * std::numbers::sqrt2);
}

/// Standard deviation of normal white noise by the median change, which a minority of moving or
/// wild values leaves as it is. At least two values.
[[nodiscard]] inline double sigma_of_changes(std::span<const double> values) {
  std::vector<double> changes;
  changes.reserve(values.size());
  for (std::size_t k = 1; k < values.size(); ++k) {
    changes.push_back(std::abs(values[k] - values[k - 1]));
  }
  return sigma_by_median(std::move(changes));
}

/// Values behind the start of a recording that say which values of the start are wild.
inline constexpr std::size_t kBehindStart = 65;

/// Distance from the level that makes a value of the start wild: 20 standard deviations.
[[nodiscard]] inline double wild_distance(std::span<const double> behind_start) {
  return 20.0 * sigma_of_changes(behind_start.first(kBehindStart));
}

}  // namespace zerorate::statistics

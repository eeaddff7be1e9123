/// @file
/// Order statistics without sorting.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace zerorate::statistics {

/// Median; of an even number of values the upper one of the middle two. Linear in their number.
/// @param values  at least one
[[nodiscard]] inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Quantile p of values in increasing order, interpolated between neighbours (position p (n - 1)).
/// @param sorted  at least one
/// @param p  from 0 to 1
[[nodiscard]] inline double quantile_of_sorted(std::span<const double> sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

}  // namespace zerorate::statistics

/// @file
/// Order statistics without sorting.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace zerorate::statistics {

/// Median; of an even number of values the upper one of the middle two. Linear in their number.
/// @param values  at least one
[[nodiscard]] inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace zerorate::statistics

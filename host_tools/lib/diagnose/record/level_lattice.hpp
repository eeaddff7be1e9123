/// @file
/// The levels that the values of a record lie on, if they lie on any.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace zerorate::diagnose {

struct LevelLattice {
  double step = 0.0;
  double offset = 0.0;              ///< value of level 0
  std::vector<std::size_t> counts;  ///< values on each level, 0 the lowest
};

/// Levels of equal distance that hold every value to a tenth of the distance; nothing where there
/// are more than a quarter as many levels as values. O(n log n).
[[nodiscard]] std::optional<LevelLattice> find_lattice(std::span<const double> values);

/// How often the least and the greatest value occur.
struct ExtremeCounts {
  std::size_t lowest = 0;
  std::size_t highest = 0;
};
[[nodiscard]] ExtremeCounts count_extremes(std::span<const double> values);

}  // namespace zerorate::diagnose

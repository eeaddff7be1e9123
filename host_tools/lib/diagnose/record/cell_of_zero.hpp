/// @file
/// How many more samples the level 0 holds than the smooth density of its neighbours lets expect.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace zerorate::diagnose {

/// Samples on the levels about zero.
struct LevelsAboutZero {
  static constexpr int kReach = 16;  ///< levels on each side

  double step = 0.0;
  std::vector<double> counts;  ///< samples on the levels -kReach to kReach

  [[nodiscard]] double count(int level) const {
    const int place = level + kReach;
    return counts[static_cast<std::size_t>(place)];
  }
};

/// Least distance of values that all are whole multiples of it, to a tenth; nothing where they are
/// none, or zero is not among them.
[[nodiscard]] std::optional<double> step_of(const std::map<float, std::size_t>& values);

/// @param values  whole multiples of the step, or too far away to matter
[[nodiscard]] LevelsAboutZero levels_about_zero(const std::map<float, std::size_t>& values,
                                                double step);

/// Logarithm of the width of the cell of zero over that of the others, by a Poisson regression on
/// a smooth density. The deviation contains how much the other levels scatter about the density.
struct WidthOfZero {
  double log_width = 0.0;
  double deviation = 0.0;
  double freedom = 0.0;  ///< degrees of freedom of the deviation
};

/// @param offset  distance of the middle of the first cell from zero, in steps, less 1: 0 for
/// rounded, 1/2 for truncated samples
/// @return nothing where too few levels about zero are hit
[[nodiscard]] std::optional<WidthOfZero> width_of_zero(const LevelsAboutZero& levels,
                                                       double offset);

}  // namespace zerorate::diagnose

/// @file
/// Samples that a chip or a library has cut toward zero instead of rounding them.
#pragma once

#include <cstddef>
#include <optional>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::diagnose {

/// A cut toward zero, as the level 0 shows it: its cell is twice as wide as the others.
struct Truncation {
  double step_rad_s = 0.0;
  double width = 1.0;  ///< width of the cell of zero over that of the others
  double width_lo = 0.0;
  double width_hi = 0.0;  ///< 95 %
  double surprisal_nats = 0.0;
};

/// Evidence for a cut toward zero by the levels of all axes, at rest and on the move.
struct TruncationEvidence {
  /// Surprisal of a level 0 that is hit so often, were the samples rounded.
  double surprisal_nats = 0.0;
  bool is_examined = false;  ///< false: no levels, or too few about zero are hit
  std::size_t axes = 0;      ///< axes of the sensor
  std::optional<Truncation> found{};
};

/// Looks for the cut: more samples on the level 0 than the smooth density of its neighbours lets
/// expect, and twice as many within what is known of it.
[[nodiscard]] TruncationEvidence find_truncation(const identify::RestSamples& samples);
inline constexpr double kTruncationThreshold_nats = 8.1;  ///< least surprisal, as of any effect

/// Undoes the cut by half a step away from zero. A sample on the level 0 takes the half step up or
/// down by a draw, as often as the levels beside it let expect, so that all cells are of one width.
/// A node leaves such a sample where it is: the mean is the same.
[[nodiscard]] identify::RestSamples without_truncation(identify::RestSamples samples,
                                                       const Truncation& truncation);

}  // namespace zerorate::diagnose

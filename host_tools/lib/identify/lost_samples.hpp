/// @file
/// Samples of a sensor that a recording lacks, one here and one there.
#pragma once

#include <span>

#include "core/base/time.hpp"

namespace zerorate::identify {

/// Shares of the samples that are lost at random, 0 to 1, by two views of the stamps.
struct LostShare {
  /// Shortest common interval against the mean one. A coarse or jittery clock has such intervals,
  /// too.
  double by_intervals = 0.0;
  /// Variance of the duration of m samples over m times the square of their mean interval: of a
  /// regular train with a share q lost it is q for every m, and jitter of a clock adds the less the
  /// larger m.
  double by_unevenness = 0.0;
  double most_by_unevenness = 0.0;  ///< with one standard error of the variance of so many blocks
  core::Duration mean_interval;     ///< between the samples that were recorded

  /// The share that both views confirm.
  [[nodiscard]] double certain() const {
    return by_intervals < most_by_unevenness ? by_intervals : most_by_unevenness;
  }
};

/// Judges blocks of 64, 256 and 1024 samples, of which a recording has 32 at least; none lost where
/// it is shorter. Where it shares stamps the blocks are whole bursts of at least so many samples,
/// and 16 are enough.
/// @param times  ascending
/// @param shares_stamps  most intervals were made by the reader, and confirm nothing
[[nodiscard]] LostShare lost_share(std::span<const core::Instant> times, bool shares_stamps);

}  // namespace zerorate::identify

/// @file
/// Samples of a sensor that a recording lacks, one here and one there.
#pragma once

#include <span>

#include "core/base/time.hpp"

namespace zerorate::identify {

/// Shares of the samples that are lost at random, 0 to 1, by two views of the stamps.
struct LostShare {
  /// By the shortest common interval against the mean one. A coarse or jittery clock has such
  /// intervals, too.
  double by_intervals = 0.0;
  /// By how unevenly samples come: where a share q of a regular train is lost, the duration of m
  /// samples has m q times the square of its mean interval as variance, for every m. Jitter of a
  /// clock is the less the larger m.
  double by_unevenness = 0.0;
  core::Duration mean_interval;  ///< of the samples that are there

  /// The share that both views confirm.
  [[nodiscard]] double certain() const {
    return by_intervals < by_unevenness ? by_intervals : by_unevenness;
  }
};

/// Judges blocks of 64, 256 and 1024 samples, of which a recording has 32 at least; none lost where
/// it is shorter.
/// @param times  ascending
[[nodiscard]] LostShare lost_share(std::span<const core::Instant> times);

}  // namespace zerorate::identify

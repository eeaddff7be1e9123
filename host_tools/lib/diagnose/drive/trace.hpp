/// @file
/// Turns of gyro and reference all along the way, in which faults of single drives show.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::diagnose {

/// A stretch of the recording.
struct Interval {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;

  [[nodiscard]] double length_s() const;
  [[nodiscard]] bool overlaps(const Interval& other) const {
    return from_ns < other.to_ns && other.from_ns < to_ns;
  }
};

/// A drive from the middle of a stop to the middle of the next.
struct TracedDrive {
  std::size_t number = 0;  ///< place in the recording, flawed drives counted
  Interval all;
  Interval moving;          ///< from departure to arrival
  double bias_rad_s = 0.0;  ///< mean rate of the gyro at rest on both sides
};

/// Turns over a stretch, the bias taken off the gyro's.
struct TurnPair {
  double gyro_rad = 0.0;
  double reference_rad = 0.0;

  [[nodiscard]] double parted_rad() const { return reference_rad - gyro_rad; }
};

/// Rows of a recording before any node.
struct Trace {
  truth::Series gyro_rad;  ///< turn about the vertical in the reference's sense, by trapezoids
  truth::Series reference_rad;
  std::int64_t longest_ns = 0;  ///< longest interval of the reference that is interpolated over
  double row_interval_s = 0.0;  ///< median
  double reference_interval_s = 0.0;  ///< median
  std::vector<Interval> gaps;         ///< stretches without a rate, three intervals and more
  std::vector<Interval> clipped;      ///< rows that repeat the largest or the least rate of all
  std::vector<TracedDrive> drives;
  double delay_s = 0.0;  ///< delay of the reference; negative: it is ahead

  /// Turns over a stretch of a drive, those of the reference as much later as it is late; nullopt
  /// where there is no heading.
  [[nodiscard]] std::optional<TurnPair> turns(const TracedDrive& drive,
                                              const Interval& stretch) const;
};

/// Reads the rows of a recording once more.
/// Throws recording::Error.
[[nodiscard]] Trace read_trace(const recording::Input& input, const truth::Truth& truth);

/// Stretches of equal length, at least, that lie in another one side by side.
[[nodiscard]] std::vector<Interval> windows_in(const Interval& all, double length_s);

}  // namespace zerorate::diagnose

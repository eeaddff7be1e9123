/// @file
/// Track of a reference system beside the gyro: columns of a recording, kept in memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::truth {

/// A quantity of the reference at the rows that have it, in the order of time.
class Series {
 public:
  /// @param time_ns later than those before
  void add(std::int64_t time_ns, double value) {
    time_ns_.push_back(time_ns);
    value_.push_back(value);
  }

  [[nodiscard]] std::size_t size() const { return value_.size(); }
  [[nodiscard]] std::int64_t time_ns(std::size_t k) const { return time_ns_[k]; }
  [[nodiscard]] double value(std::size_t k) const { return value_[k]; }
  /// Index of the first value at a time or after it; size() where there is none.
  [[nodiscard]] std::size_t first_from(std::int64_t time_ns) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(time_ns_, time_ns) - time_ns_.begin());
  }

  /// Longest interval that is interpolated over: three median intervals, and at least 2 s, so that
  /// a reference of 1 Hz may miss a sample.
  [[nodiscard]] std::int64_t longest_interval_ns() const;
  /// The linear interpolation; nullopt outside the series and in intervals that are longer.
  [[nodiscard]] std::optional<double> at(std::int64_t time_ns, std::int64_t longest_ns) const;
  /// Whether no interval between two times is longer, and both lie within the series.
  [[nodiscard]] bool covers(std::int64_t from_ns, std::int64_t to_ns,
                            std::int64_t longest_ns) const;

 private:
  std::vector<std::int64_t> time_ns_;
  std::vector<double> value_;
};

/// The reference of a recording, and what the gyro turned meanwhile.
struct Track {
  std::size_t axis_count = 3;
  /// Unwrapped [rad]: `ref_heading_deg`, or else the integral of `ref_rate_dps`.
  Series heading_rad;
  Series speed_m_s;  ///< its size, without a sign
  /// Integral of the gyro's axes up to each time of heading_rad [rad]; a lost rate counts as the
  /// one before.
  std::vector<std::array<double, recording::kMaxAxes>> turned_rad;

  /// Turn of the gyro's axis from one heading to another [rad].
  [[nodiscard]] double turn_rad(std::size_t axis, std::size_t from, std::size_t to) const {
    return turned_rad[to][axis] - turned_rad[from][axis];
  }
};

/// Reads a recording to its end. Rows whose time does not advance are left out. Two headings in
/// succession are taken for less than half a turn apart. Memory: 56 bytes a row.
/// Throws recording::Error.
[[nodiscard]] Track read_track(recording::Reader& reader);

}  // namespace zerorate::truth

/// @file
/// Oddities of a readable recording: flagged row by row and counted.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace zerorate::recording {

struct Row;
struct Columns;
struct LeftOut;

/// One kind of oddity of a row.
enum class Finding : std::uint8_t {
  rate_lost,          ///< a rate is empty, nan or infinite: the sample cannot be used
  rate_implausible,   ///< a rate beyond 4000 deg/s, the widest range sold: raw counts, wrong unit?
  temperature_lost,   ///< the temperature is empty, nan or infinite
  acceleration_lost,  ///< an acceleration is empty, nan or infinite
  time_stray,         ///< a stamp far from those of its neighbours; the row is left out
  row_repeated,       ///< a copy of the row before; the row is left out
  clock_step,       ///< the clock was set back or began again: the time line goes on after a pause
  counter_wrapped,  ///< the counter of the clock began again: it is counted on
  time_sorted,      ///< the row was out of order, and stands where its stamp belongs
  time_spread,      ///< several rows shared a stamp: its time is that of even samples
  gap,              ///< more than kGapPeriods median periods since the latest time so far
  odometer_backwards,  ///< the pulse count is below that of the row before
  line_unterminated,   ///< the last line does not end in a newline: the file may have been cut
  reference_missing,   ///< heading, rate or speed of the reference is empty, nan or infinite
  line_damaged,        ///< the last line is not whole; it is left out
  motion_unknown,      ///< no word of the speed for too long: the vehicle counts as moving
};
inline constexpr std::size_t kFindingCount = 16;

/// A gap is an interval longer than this many median intervals.
inline constexpr std::int64_t kGapPeriods = 10;

/// Pauses up to this long, however short the median interval, may belong to reading in bursts [ns].
inline constexpr std::int64_t kShortestHole = 500'000'000;

/// A short description for the user, such as "time runs backwards".
[[nodiscard]] std::string_view description(Finding finding);

/// The findings of one row.
class FindingSet {
 public:
  void add(Finding finding) { bits_.set(static_cast<std::size_t>(finding)); }
  [[nodiscard]] bool has(Finding finding) const {
    return bits_.test(static_cast<std::size_t>(finding));
  }
  [[nodiscard]] bool empty() const { return bits_.none(); }

  bool operator==(const FindingSet&) const = default;

 private:
  std::bitset<kFindingCount> bits_;
};

/// The running median of a stream of intervals, in constant memory (16 KiB) and amortised constant
/// time: the mean of the median's bin in a histogram with 16 bins per octave. It is exact where the
/// intervals are equal, and within 6.3 % of the exact (lower) median in any case.
class IntervalMedian {
 public:
  /// Adds an interval of at least 1 ns; all of them together must be below 2^64 ns.
  void add(std::int64_t interval_ns);
  /// 0 before the first interval.
  [[nodiscard]] std::int64_t value_ns() const;

 private:
  static constexpr std::size_t kBinsPerOctave = 16;

  struct Bin {
    std::uint64_t count = 0;
    std::uint64_t sum_ns = 0;
  };

  std::array<Bin, 63 * kBinsPerOctave> bins_{};
  std::uint64_t total_ = 0;
  std::size_t median_bin_ = 0;
  std::uint64_t below_median_bin_ = 0;
};

/// The findings of all rows read so far.
class Findings {
 public:
  /// Looks at the next row of the file, adds what it finds to row.findings and counts all of them.
  void examine(Row& row, const Columns& columns, std::uint64_t line);

  /// Counts rows that were read and not given, once, at the end.
  void add_left_out(const LeftOut& left_out);

  /// Program that wrote the file, where it was recognised; else empty.
  [[nodiscard]] std::string_view program() const { return program_; }
  /// Rows that were given.
  [[nodiscard]] std::uint64_t rows() const { return rows_; }
  /// Rows that were read and not given.
  [[nodiscard]] std::uint64_t left_out() const {
    return count(Finding::time_stray) + count(Finding::row_repeated);
  }
  [[nodiscard]] std::uint64_t count(Finding finding) const {
    return counts_[static_cast<std::size_t>(finding)];
  }
  /// The line of the first row with the finding; 0 where there is none.
  [[nodiscard]] std::uint64_t first_line(Finding finding) const {
    return first_lines_[static_cast<std::size_t>(finding)];
  }
  /// Mean size of the acceleration over the rows that have one, which is near that of gravity even
  /// in a vehicle that moves [m/s2]; nullopt without any.
  [[nodiscard]] std::optional<double> mean_acceleration_m_s2() const;
  /// Median interval between rows (see IntervalMedian); 0 below two rows.
  [[nodiscard]] std::int64_t median_interval_ns() const { return median_.value_ns(); }
  /// Mean interval between rows, holes left out: gaps that are longer than kShortestHole. Where a
  /// sensor is read in bursts this is its sample period, and the median is not; without bursts they
  /// are the same but for lost rows. 0 below two rows.
  [[nodiscard]] std::int64_t mean_interval_ns() const;
  /// Longest interval between rows and the line at its end; 0 below two rows.
  [[nodiscard]] std::int64_t longest_interval_ns() const { return longest_interval_ns_; }
  [[nodiscard]] std::uint64_t longest_interval_line() const { return longest_interval_line_; }

 private:
  void examine_time(Row& row, std::uint64_t line);
  void examine_acceleration(Row& row);
  void count(const FindingSet& set, std::uint64_t line);

  std::string_view program_;
  std::uint64_t rows_ = 0;
  std::array<std::uint64_t, kFindingCount> counts_{};
  std::array<std::uint64_t, kFindingCount> first_lines_{};
  IntervalMedian median_;
  std::uint64_t without_holes_ns_ = 0;  ///< sum of the intervals that are no holes
  std::uint64_t intervals_ = 0;         ///< intervals in this sum
  std::int64_t longest_interval_ns_ = 0;
  std::uint64_t longest_interval_line_ = 0;
  std::int64_t latest_time_ns_ = 0;
  std::int64_t last_odometer_pulses_ = 0;
  double sum_of_accelerations_m_s2_ = 0.0;
  std::uint64_t accelerations_ = 0;  ///< rows in this sum
};

/// Sentence about accelerations whose mean size is not that of gravity, with the figure and the
/// likely reason, such as "g taken for m/s2?"; empty where it is, or where there are none.
[[nodiscard]] std::string doubt_of_acceleration(const Findings& findings);

/// Sentence for the first line of a result, where more than 1 % of the rows cannot be used or the
/// stamps of more than 5 % were repaired; else empty.
[[nodiscard]] std::string doubt_of_rows(const Findings& findings);

/// Sentence about a mean interval that no gyro has, from which other unit of the stamps would
/// serve, and what keeps it; empty from 20 us to 2 s.
[[nodiscard]] std::string doubt_of_period(std::int64_t period_ns);

/// Throws DataError where more than half of the rows were left out.
void require_most_rows(const Findings& findings);

}  // namespace zerorate::recording

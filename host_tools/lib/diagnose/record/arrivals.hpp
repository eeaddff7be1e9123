/// @file
/// Lost samples of a record, found by its time stamps.
#pragma once

#include <cstddef>
#include <vector>

#include "host_tools/lib/diagnose/record/record.hpp"

namespace zerorate::diagnose {

/// Losses of a record.
struct Losses {
  std::size_t expected = 0;  ///< samples, had none been lost
  std::size_t lost = 0;
  std::size_t repeated = 0;  ///< lost samples in whose place the sample before came again
  std::size_t runs = 0;    ///< runs of lost samples; in bursts: gaps above kLongGap mean intervals
  double jitter = 0.0;     ///< rms deviation of the stamps from even ones, in periods
  bool is_uneven = false;  ///< less than 0.7 of the grid is filled
  /// Uneven, and the stamps lie on no grid: batches that were stamped when they were read. How many
  /// samples are missing is unknown, `expected` and `lost` are 0.
  bool in_bursts = false;
  double gaps_s = 0.0;  ///< in bursts: all gaps together

  static constexpr double kLongGap = 5.0;
};

/// Places of samples on a grid whose period is the mean of the intervals near the median one, and
/// the samples that are missing there.
struct Arrivals {
  double period_s = 0.0;
  std::vector<std::size_t> places;  ///< one a sample, not descending
  Losses losses;
};

/// The phase of the grid follows the stamps. Where they jitter by more than an eighth of a period a
/// sample counts as late, and not as the first after a loss, unless most of the seven from it on
/// are late. O(n).
[[nodiscard]] Arrivals place_samples(const Record& record);

/// The samples, by index and ascending, whose rate is exactly that of the sample before, where that
/// happens four times as often as chance makes it: equal neighbours by chance are as frequent as
/// neighbours that differ by the least difference, or by any one number, one way. Nothing where a
/// single value makes up a fifth of them: a range that ends, a dead band. O(n log n).
[[nodiscard]] std::vector<std::size_t> find_repeated_samples(const Record& record);

/// The record without these samples.
[[nodiscard]] Record without_samples(const Record& record,
                                     const std::vector<std::size_t>& left_out);

}  // namespace zerorate::diagnose

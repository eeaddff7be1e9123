/// @file
/// A record on an even grid; lost values are marked and filled in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_tools/lib/diagnose/record/arrivals.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"

namespace zerorate::diagnose {

struct EvenSeries {
  double period_s = 0.0;
  double start_s = 0.0;  ///< time of the first sample, on the record's clock
  std::vector<double> rate_rad_s;
  std::vector<double> temperature_degc;  ///< one for each value, or none
  std::vector<bool> lost;                ///< no sample there: the rate is a placeholder
  Losses losses;                         ///< losses of the whole record
  double span_s = 0.0;                   ///< length of the whole record
  /// Distance of the first value from the following ones, if it counts as a switch-on transient and
  /// as lost; else 0.
  double start_off_rad_s = 0.0;
  /// Means over ticks, because the samples come too unevenly; a value holds some of them.
  bool is_ticks = false;

  [[nodiscard]] std::size_t size() const { return rate_rad_s.size(); }
  [[nodiscard]] double time_s(std::size_t k) const {
    return start_s + period_s * static_cast<double>(k);
  }
};

/// Samples go to a grid whose period is the mean of the intervals near the median one, where at
/// least 0.7 of it is filled; else means are taken over ticks of which nearly all hold samples.
/// Where holes are long, the longest stretch without a hole of more than 50 values is kept, if it
/// is a third of the record or more. A sample that repeats the one before is as good as lost
/// (find_repeated_samples). Lost values are filled by a straight line between the means on both
/// sides.
[[nodiscard]] EvenSeries even_series_of(const Record& record);

/// Number of values whose means show slow effects as well as the values do, so that these are
/// judged on the same means however the data were sampled. 1 where a record is too short for means.
/// The number has small factors, and its means cover as much of the record as a fast transform can.
[[nodiscard]] std::size_t values_a_slow_mean(const EvenSeries& series);

/// Means over `count` neighbours; those at the end that fill no mean are left out. A mean of which
/// half the values are lost is lost.
[[nodiscard]] EvenSeries means_of(const EvenSeries& series, std::size_t count);

}  // namespace zerorate::diagnose

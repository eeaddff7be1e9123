#include "host_tools/lib/recording/findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/units.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/row.hpp"
#include "host_tools/lib/recording/row_source.hpp"

namespace zerorate::recording {
namespace {

constexpr float kImplausibleRateRadS = static_cast<float>(4000.0 * std::numbers::pi / 180.0);

void examine_rates(Row& row, const Columns& columns) {
  for (std::size_t axis = 0; axis < columns.axis_count; ++axis) {
    if (!std::isfinite(row.rate_rad_s[axis])) {
      row.findings.add(Finding::rate_lost);
    } else if (std::abs(row.rate_rad_s[axis]) > kImplausibleRateRadS) {
      row.findings.add(Finding::rate_implausible);
    }
  }
}

bool misses_reference(const Row& row, const Columns& columns) {
  return (columns.ref_heading && !std::isfinite(row.ref_heading_rad)) ||
         (columns.ref_rate && !std::isfinite(row.ref_rate_rad_s)) ||
         (columns.ref_speed && !std::isfinite(row.ref_speed_m_s));
}

/// later - earlier for later > earlier; the longest interval where 64 bits are not enough.
std::int64_t interval(std::int64_t earlier, std::int64_t later) {
  const auto difference = static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
  constexpr auto kLongest = std::numeric_limits<std::int64_t>::max();
  return difference > static_cast<std::uint64_t>(kLongest) ? kLongest
                                                           : static_cast<std::int64_t>(difference);
}

}  // namespace

std::string_view description(Finding finding) {
  switch (finding) {
    case Finding::rate_lost:
      return "rate is empty, nan or infinite";
    case Finding::rate_implausible:
      return "rate beyond 4000 deg/s (raw counts, or the wrong unit?)";
    case Finding::temperature_lost:
      return "temperature is empty, nan or infinite";
    case Finding::acceleration_lost:
      return "acceleration is empty, nan or infinite";
    case Finding::time_stray:
      return "time stamp far from those around it, left out";
    case Finding::row_repeated:
      return "the row before once more, left out";
    case Finding::clock_step:
      return "time runs backwards (clock set, or a new recording): goes on after a pause";
    case Finding::counter_wrapped:
      return "counter of the time began again: counted on";
    case Finding::time_sorted:
      return "out of order, put where the time stamp belongs";
    case Finding::time_spread:
      return "time stamp shared by several samples, spread evenly";
    case Finding::gap:
      return "gap of more than 10 median periods";
    case Finding::odometer_backwards:
      return "odometer count runs backwards";
    case Finding::line_unterminated:
      return "last line has no line end (file cut off?)";
    case Finding::line_damaged:
      return "the end of the file is damaged, left out";
    case Finding::reference_missing:
      return "heading, rate or speed of the reference is empty, nan or infinite";
    case Finding::motion_unknown:
      return "no word of the speed for more than a second and three of its intervals: the vehicle "
             "counts as moving";
  }
  return "unknown finding";
}

void IntervalMedian::add(std::int64_t interval_ns) {
  const auto ns = static_cast<std::uint64_t>(interval_ns);
  const auto octave = static_cast<unsigned>(std::bit_width(ns)) - 1U;
  const auto step = static_cast<std::size_t>(octave >= 4 ? ns >> (octave - 4) : ns << (4 - octave));
  const std::size_t bin = octave * kBinsPerOctave + (step - kBinsPerOctave);
  ++bins_[bin].count;
  bins_[bin].sum_ns += ns;
  if (bin < median_bin_) {
    ++below_median_bin_;
  }
  ++total_;
  const std::uint64_t rank = (total_ - 1) / 2;
  while (below_median_bin_ > rank) {
    --median_bin_;
    below_median_bin_ -= bins_[median_bin_].count;
  }
  while (below_median_bin_ + bins_[median_bin_].count <= rank) {
    below_median_bin_ += bins_[median_bin_].count;
    ++median_bin_;
  }
}

std::int64_t IntervalMedian::value_ns() const {
  const Bin& bin = bins_[median_bin_];
  return bin.count == 0 ? 0 : static_cast<std::int64_t>(bin.sum_ns / bin.count);
}

std::int64_t Findings::mean_interval_ns() const {
  return intervals_ == 0 ? 0 : static_cast<std::int64_t>(without_holes_ns_ / intervals_);
}

void Findings::examine(Row& row, const Columns& columns, std::uint64_t line) {
  program_ = columns.program;
  examine_rates(row, columns);
  if (columns.temperature && !std::isfinite(row.temperature_degc)) {
    row.findings.add(Finding::temperature_lost);
  }
  if (columns.acceleration) examine_acceleration(row);
  if (misses_reference(row, columns)) {
    row.findings.add(Finding::reference_missing);
  }
  if (rows_ == 0) {
    latest_time_ns_ = row.time_ns;
  } else {
    examine_time(row, line);
    if (row.odometer_pulses < last_odometer_pulses_) {
      row.findings.add(Finding::odometer_backwards);
    }
  }
  last_odometer_pulses_ = row.odometer_pulses;
  ++rows_;
  count(row.findings, line);
}

void Findings::examine_acceleration(Row& row) {
  if (!row.has_acceleration()) {
    row.findings.add(Finding::acceleration_lost);
    return;
  }
  const auto& [x, y, z] = row.acceleration_m_s2;
  sum_of_accelerations_m_s2_ += std::hypot(double{x}, double{y}, double{z});
  ++accelerations_;
}

std::optional<double> Findings::mean_acceleration_m_s2() const {
  if (accelerations_ == 0) return std::nullopt;
  return sum_of_accelerations_m_s2_ / static_cast<double>(accelerations_);
}

std::string doubt_of_acceleration(const Findings& findings) {
  // Errors of offset and scale, and a rough road, change the mean by less than this share.
  constexpr double kPlausible = 0.3;
  constexpr double kGravity_m_s2 = core::kStandardGravity_m_s2;
  const auto is_near = [](double size, double expected) {
    return std::abs(size / expected - 1.0) <= kPlausible;
  };
  const std::optional<double> mean = findings.mean_acceleration_m_s2();
  if (!mean || is_near(*mean, kGravity_m_s2)) return "";
  std::string_view reason = "raw counts, another unit, or gravity taken off?";
  if (is_near(*mean, 1.0)) reason = "g taken for m/s2?";
  if (is_near(*mean, kGravity_m_s2 * kGravity_m_s2)) reason = "m/s2 taken for g?";
  return fmt::format("acceleration of {:.4g} m/s2 in the mean, where gravity is 9.8 m/s2 ({})",
                     *mean, reason);
}

void Findings::examine_time(Row& row, std::uint64_t line) {
  if (row.time_ns <= latest_time_ns_) return;
  const std::int64_t interval_ns = interval(latest_time_ns_, row.time_ns);
  const std::int64_t median_ns = median_.value_ns();
  const bool is_gap = median_ns > 0 && (interval_ns - 1) / kGapPeriods >= median_ns;
  if (is_gap) {
    row.findings.add(Finding::gap);
  }
  if (!is_gap || interval_ns <= kShortestHole) {
    without_holes_ns_ += static_cast<std::uint64_t>(interval_ns);
    ++intervals_;
  }
  if (interval_ns > longest_interval_ns_) {
    longest_interval_ns_ = interval_ns;
    longest_interval_line_ = line;
  }
  median_.add(interval_ns);
  latest_time_ns_ = row.time_ns;
}

void Findings::add_left_out(const LeftOut& left_out) {
  const auto set = [&](Finding finding, std::uint64_t rows, std::uint64_t line) {
    counts_[static_cast<std::size_t>(finding)] = rows;
    first_lines_[static_cast<std::size_t>(finding)] = line;
  };
  set(Finding::time_stray, left_out.stray, left_out.first_stray_line);
  set(Finding::line_damaged, left_out.damaged, left_out.damaged_line);
  set(Finding::row_repeated, left_out.repeated, left_out.first_repeated_line);
}

std::string doubt_of_rows(const Findings& findings) {
  constexpr double kUnused = 0.01;
  constexpr double kRepaired = 0.05;
  const auto rows = static_cast<double>(findings.rows() + findings.left_out());
  const auto share = [&](std::uint64_t count) { return static_cast<double>(count) / rows; };
  const auto percent = [](double part) {
    return part < 0.1 ? fmt::format("{:.2g}", 100.0 * part) : fmt::format("{:.0f}", 100.0 * part);
  };
  const double unused = share(findings.left_out() + findings.count(Finding::rate_lost));
  // A row may have been both.
  const double repaired = std::min(
      1.0, share(findings.count(Finding::time_sorted) + findings.count(Finding::time_spread)));
  std::string doubt;
  if (unused > kUnused) doubt = fmt::format("{} % of the rows were not used", percent(unused));
  if (repaired > kRepaired) {
    doubt += fmt::format("{}the time stamps of {} % of the rows were repaired",
                         doubt.empty() ? "" : ", and ", percent(repaired));
  }
  return doubt;
}

std::string doubt_of_period(std::int64_t period_ns) {
  constexpr std::int64_t kShortest_ns =
      20'000;  // the fastest MEMS gyros give 32,000 samples a second
  constexpr std::int64_t kLongest_ns = 2'000'000'000;
  if (period_ns >= kShortest_ns && period_ns <= kLongest_ns) return "";
  const double period_s = static_cast<double>(period_ns) * 1e-9;
  return fmt::format(
      "a sample every {:.3g} s, and gyros are recorded at {}: {}? --units time=... names another "
      "unit; --rows-at {:.4g} keeps this one",
      period_s, period_ns < kShortest_ns ? "32 kHz at most" : "0.5 Hz at least",
      period_ns < kShortest_ns ? "milliseconds named microseconds, or seconds named milliseconds"
                               : "milliseconds named seconds",
      1.0 / period_s);
}

void require_most_rows(const Findings& findings) {
  if (findings.left_out() <= findings.rows()) return;
  throw DataError(fmt::format(
      "{} of {} rows have no usable time stamp or repeat the row before: too few are left. "
      "--rows-at HZ reads a recording without its stamps",
      findings.left_out(), findings.rows() + findings.left_out()));
}

void Findings::count(const FindingSet& set, std::uint64_t line) {
  if (set.empty()) {
    return;
  }
  for (std::size_t i = 0; i < kFindingCount; ++i) {
    if (set.has(static_cast<Finding>(i)) && ++counts_[i] == 1) {
      first_lines_[i] = line;
    }
  }
}

}  // namespace zerorate::recording

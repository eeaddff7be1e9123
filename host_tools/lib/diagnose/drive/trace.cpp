#include "host_tools/lib/diagnose/drive/trace.hpp"

#include <algorithm>
#include <cmath>

#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::seconds;

/// Rates about the vertical axis, row by row.
struct Rates {
  std::vector<std::int64_t> time_ns;
  std::vector<double> rad_s;
};

Rates read_rates(const recording::Input& input, const truth::VerticalAxis& vertical) {
  Rates rates;
  recording::Reader reader{input};
  for (recording::Row row; reader.next(row);) {
    const double rate_rad_s = vertical.sign * double{row.rate_rad_s[vertical.axis]};
    const bool advances = rates.time_ns.empty() || row.time_ns > rates.time_ns.back();
    if (!advances || !std::isfinite(rate_rad_s)) continue;
    rates.time_ns.push_back(row.time_ns);
    rates.rad_s.push_back(rate_rad_s);
  }
  return rates;
}

double median_interval_s(std::size_t size, const auto& time_ns) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < size; ++k) intervals.push_back(seconds(time_ns(k) - time_ns(k - 1)));
  return intervals.empty() ? 0.0 : statistics::median_of(intervals);
}

std::vector<Interval> gaps_of(const Rates& rates, double interval_s) {
  constexpr double kIntervals = 3.0;
  std::vector<Interval> gaps;
  for (std::size_t k = 1; k < rates.time_ns.size(); ++k) {
    const Interval between{rates.time_ns[k - 1], rates.time_ns[k]};
    if (between.length_s() >= kIntervals * interval_s) gaps.push_back(between);
  }
  return gaps;
}

/// Runs of rows at one value. Noise does not repeat the largest one of all.
void add_runs_at(double value_rad_s, const Rates& rates, std::vector<Interval>& runs) {
  constexpr std::size_t kFewestRows = 4;
  for (std::size_t first = 0; first < rates.rad_s.size();) {
    std::size_t end = first;
    while (end < rates.rad_s.size() && rates.rad_s[end] == value_rad_s) ++end;
    if (end - first >= kFewestRows) runs.push_back({rates.time_ns[first], rates.time_ns[end - 1]});
    first = std::max(end, first + 1);
  }
}

std::vector<Interval> clipped_in(const Rates& rates) {
  std::vector<Interval> clipped;
  const auto [least, most] = std::ranges::minmax(rates.rad_s);
  if (!(least < most)) return clipped;
  add_runs_at(least, rates, clipped);
  add_runs_at(most, rates, clipped);
  return clipped;
}

truth::Series integral_of(const Rates& rates) {
  truth::Series turn_rad;
  double sum_rad = 0.0;
  for (std::size_t k = 0; k < rates.rad_s.size(); ++k) {
    if (k > 0) {
      sum_rad += 0.5 * (rates.rad_s[k] + rates.rad_s[k - 1]) *
                 seconds(rates.time_ns[k] - rates.time_ns[k - 1]);
    }
    turn_rad.add(rates.time_ns[k], sum_rad);
  }
  return turn_rad;
}

/// Turn of the gyro with its bias; nullopt outside the recording.
std::optional<double> turned(const truth::Series& gyro_rad, const Interval& stretch) {
  constexpr std::int64_t kAnyGap = INT64_MAX;
  const auto first = gyro_rad.at(stretch.from_ns, kAnyGap);
  const auto last = gyro_rad.at(stretch.to_ns, kAnyGap);
  if (!first || !last) return std::nullopt;
  return *last - *first;
}

std::vector<TracedDrive> drives_of(const truth::Truth& truth, const truth::Series& gyro_rad) {
  std::vector<TracedDrive> drives;
  for (std::size_t k = 0; k < truth.drives.size(); ++k) {
    const truth::Drive& drive = truth.drives[k];
    const Interval before{drive.from_ns, drive.departure_ns};
    const Interval after{drive.arrival_ns, drive.to_ns};
    const auto first = turned(gyro_rad, before);
    const auto last = turned(gyro_rad, after);
    if (!first || !last) continue;
    drives.push_back({.number = k,
                      .all = {drive.from_ns, drive.to_ns},
                      .moving = {drive.departure_ns, drive.arrival_ns},
                      .bias_rad_s = (*first + *last) / (before.length_s() + after.length_s())});
  }
  return drives;
}

}  // namespace

double Interval::length_s() const {
  return seconds(to_ns - from_ns);
}

std::optional<TurnPair> Trace::turns(const TracedDrive& drive, const Interval& stretch) const {
  const auto late_ns = static_cast<std::int64_t>(std::llround(delay_s * 1e9));
  const auto gyro = turned(gyro_rad, stretch);
  const auto first = reference_rad.at(stretch.from_ns + late_ns, longest_ns);
  const auto last = reference_rad.at(stretch.to_ns + late_ns, longest_ns);
  if (!gyro || !first || !last) return std::nullopt;
  return TurnPair{.gyro_rad = *gyro - drive.bias_rad_s * stretch.length_s(),
                  .reference_rad = *last - *first};
}

Trace read_trace(const recording::Input& input, const truth::Truth& truth) {
  const Rates rates = read_rates(input, truth.vertical);
  Trace trace{.gyro_rad = integral_of(rates),
              .reference_rad = truth.heading_rad,
              .longest_ns = truth.heading_rad.longest_interval_ns()};
  trace.row_interval_s =
      median_interval_s(rates.time_ns.size(), [&](std::size_t k) { return rates.time_ns[k]; });
  trace.reference_interval_s = median_interval_s(
      trace.reference_rad.size(), [&](std::size_t k) { return trace.reference_rad.time_ns(k); });
  trace.gaps = gaps_of(rates, trace.row_interval_s);
  trace.clipped = clipped_in(rates);
  trace.drives = drives_of(truth, trace.gyro_rad);
  return trace;
}

std::vector<Interval> windows_in(const Interval& all, double length_s) {
  const auto count = static_cast<std::int64_t>(all.length_s() / length_s);
  std::vector<Interval> windows;
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t length_ns = (all.to_ns - all.from_ns) / count;
    windows.push_back({all.from_ns + k * length_ns, all.from_ns + (k + 1) * length_ns});
  }
  return windows;
}

}  // namespace zerorate::diagnose

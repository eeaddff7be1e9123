#include "host_tools/lib/diagnose/record/even_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/record/arrivals.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"
#include "host_tools/lib/statistics/sigma_of_changes.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kFewestFilledTicks = 0.98;
constexpr std::size_t kLongHole = 50;
constexpr std::size_t kFewestTicks = 256;
constexpr std::size_t kReach = 8;  // values on each side that a hole is filled from

/// Values by their place on a grid; means where several fall on one.
class Grid {
 public:
  explicit Grid(bool with_temperature) : with_temperature_(with_temperature) {}

  void add(std::size_t place, double rate, double temperature) {
    if (place >= sums_.size()) {
      sums_.resize(place + 1);
      counts_.resize(place + 1);
      if (with_temperature_) temperatures_.resize(place + 1);
    }
    sums_[place] += rate;
    counts_[place] += 1.0;
    if (with_temperature_) temperatures_[place] += temperature;
  }

  [[nodiscard]] double filled() const {
    const auto empty = std::ranges::count(counts_, 0.0);
    return 1.0 - static_cast<double>(empty) / static_cast<double>(counts_.size());
  }
  [[nodiscard]] std::size_t size() const { return counts_.size(); }

  [[nodiscard]] EvenSeries series(double period_s, double start_s) const {
    EvenSeries series{.period_s = period_s, .start_s = start_s};
    series.lost.resize(size());
    for (std::size_t k = 0; k < size(); ++k) {
      const bool lost = counts_[k] == 0.0;
      series.lost[k] = lost;
      series.rate_rad_s.push_back(lost ? 0.0 : sums_[k] / counts_[k]);
      if (!with_temperature_) continue;
      const double before = k > 0 ? series.temperature_degc.back() : 0.0;
      series.temperature_degc.push_back(lost ? before : temperatures_[k] / counts_[k]);
    }
    return series;
  }

 private:
  bool with_temperature_;
  std::vector<double> sums_;
  std::vector<double> counts_;
  std::vector<double> temperatures_;
};

double temperature_at(const Record& record, std::size_t k) {
  return record.temperature_degc.empty() ? 0.0 : record.temperature_degc[k];
}

EvenSeries on_sample_grid(const Record& record, const Arrivals& arrivals) {
  Grid grid(!record.temperature_degc.empty());
  for (std::size_t k = 0; k < record.size(); ++k) {
    grid.add(arrivals.places[k], record.rate_rad_s[k], temperature_at(record, k));
  }
  return grid.series(arrivals.period_s, record.time_s.front());
}

Grid ticks_of(const Record& record, double tick_s) {
  Grid grid(!record.temperature_degc.empty());
  for (std::size_t k = 0; k < record.size(); ++k) {
    const double since = record.time_s[k] - record.time_s.front();
    grid.add(static_cast<std::size_t>(since / tick_s), record.rate_rad_s[k],
             temperature_at(record, k));
  }
  return grid;
}

/// Means over the shortest ticks of which nearly all are filled.
EvenSeries on_ticks(const Record& record) {
  const double span_s = record.time_s.back() - record.time_s.front();
  const double longest_s = span_s / static_cast<double>(kFewestTicks);
  const double mean_interval_s = span_s / static_cast<double>(record.size() - 1);
  double tick_s = std::min(4.0 * mean_interval_s, longest_s);
  while (2.0 * tick_s <= longest_s && ticks_of(record, tick_s).filled() < kFewestFilledTicks) {
    tick_s *= 2.0;
  }
  EvenSeries series = ticks_of(record, tick_s).series(tick_s, record.time_s.front());
  series.is_ticks = true;
  return series;
}

/// Calls visit(first, end) for each run of lost values.
template <class Visit>
void for_each_hole(const std::vector<bool>& lost, Visit visit) {
  for (std::size_t k = 0; k < lost.size(); ++k) {
    if (!lost[k]) continue;
    std::size_t end = k;
    while (end < lost.size() && lost[end]) ++end;
    visit(k, end);
    k = end;
  }
}

void keep(EvenSeries& series, std::size_t first, std::size_t end) {
  const auto cut = [&](auto& values) {
    if (values.empty()) return;
    using Difference = typename std::decay_t<decltype(values)>::difference_type;
    values.erase(values.begin() + static_cast<Difference>(end), values.end());
    values.erase(values.begin(), values.begin() + static_cast<Difference>(first));
  };
  series.start_s = series.time_s(first);
  cut(series.rate_rad_s);
  cut(series.temperature_degc);
  cut(series.lost);
}

void keep_longest_stretch(EvenSeries& series) {
  std::size_t begin = 0;
  std::size_t best_first = 0;
  std::size_t best_end = 0;
  const auto close = [&](std::size_t end) {
    if (end - begin > best_end - best_first) {
      best_first = begin;
      best_end = end;
    }
  };
  for_each_hole(series.lost, [&](std::size_t first, std::size_t end) {
    if (end - first <= kLongHole) return;
    close(first);
    begin = end;
  });
  close(series.size());
  if (3 * (best_end - best_first) >= series.size()) keep(series, best_first, best_end);
}

/// The mean of the values that are there within reach on one side; NaN where there are none.
double level_beside(const EvenSeries& series, std::size_t edge, bool after) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < 4 * kReach && count < static_cast<double>(kReach); ++i) {
    if (after ? edge + i >= series.size() : i >= edge) break;
    const std::size_t k = after ? edge + i : edge - 1 - i;
    if (series.lost[k]) continue;
    sum += series.rate_rad_s[k];
    count += 1.0;
  }
  return count > 0.0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

void fill_holes(EvenSeries& series) {
  for_each_hole(series.lost, [&](std::size_t first, std::size_t end) {
    double before = level_beside(series, first, false);
    double after = level_beside(series, end, true);
    if (std::isnan(before)) before = after;
    if (std::isnan(after)) after = before;
    const auto width = static_cast<double>(end - first + 1);
    for (std::size_t k = first; k < end; ++k) {
      const double share = static_cast<double>(k - first + 1) / width;
      series.rate_rad_s[k] = (1.0 - share) * before + share * after;
    }
  });
}

/// Many sensors deliver one wild value after switch-on.
void leave_out_start(EvenSeries& series) {
  constexpr std::size_t kNext = 9;
  if (series.size() <= statistics::kBehindStart) return;
  const auto behind = std::span<const double>{series.rate_rad_s}.subspan(1);
  const auto next = behind.first(kNext);
  const double off =
      series.rate_rad_s.front() - statistics::median_of(std::vector(next.begin(), next.end()));
  if (std::abs(off) <= statistics::wild_distance(behind)) return;
  series.start_off_rad_s = off;
  series.lost.front() = true;
}

EvenSeries series_of_arrived(const Record& record) {
  const Arrivals arrivals = place_samples(record);
  EvenSeries series =
      arrivals.losses.is_uneven ? on_ticks(record) : on_sample_grid(record, arrivals);
  series.losses = arrivals.losses;
  series.span_s = record.time_s.back() - record.time_s.front();
  keep_longest_stretch(series);
  leave_out_start(series);
  fill_holes(series);
  return series;
}

}  // namespace

EvenSeries even_series_of(const Record& record) {
  const std::vector<std::size_t> repeated = find_repeated_samples(record);
  EvenSeries series = repeated.empty() ? series_of_arrived(record)
                                       : series_of_arrived(without_samples(record, repeated));
  series.losses.repeated = repeated.size();
  // Values and means have to cover the same time.
  const std::size_t count = values_a_slow_mean(series);
  if (count > 1) keep(series, 0, count * spectrum::fast_length_below(series.size() / count));
  return series;
}

std::size_t values_a_slow_mean(const EvenSeries& series) {
  constexpr double kLongestMean_s = 1.0;  // shorter than any stop or drive
  constexpr std::size_t kFewestMeans = 8192;
  constexpr std::size_t kFewestValues = 4;  // else nothing would be saved
  const auto longest = static_cast<std::size_t>(std::lround(kLongestMean_s / series.period_s));
  std::size_t best = 1;
  std::size_t most = 0;
  for (std::size_t count = std::min(longest, series.size() / kFewestMeans); count >= kFewestValues;
       --count) {
    const std::size_t covered = count * spectrum::fast_length_below(series.size() / count);
    if (spectrum::fast_length_below(2 * count) != 2 * count || covered <= most) continue;
    best = count;
    most = covered;
  }
  return best;
}

EvenSeries means_of(const EvenSeries& series, std::size_t count) {
  const auto width = static_cast<std::ptrdiff_t>(count);
  const auto mean_at = [&](const std::vector<double>& values, std::size_t k) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(k) * width;
    return std::accumulate(first, first + width, 0.0) / static_cast<double>(count);
  };
  EvenSeries means{
      .period_s = series.period_s * static_cast<double>(count),
      .start_s = series.start_s + 0.5 * series.period_s * static_cast<double>(count - 1),
      .losses = series.losses,
      .span_s = series.span_s,
      .is_ticks = true};
  for (std::size_t k = 0; k < series.size() / count; ++k) {
    const auto first_lost = series.lost.begin() + static_cast<std::ptrdiff_t>(k) * width;
    const auto lost = static_cast<std::size_t>(std::count(first_lost, first_lost + width, true));
    means.rate_rad_s.push_back(mean_at(series.rate_rad_s, k));
    means.lost.push_back(2 * lost >= count);
    if (!series.temperature_degc.empty()) {
      means.temperature_degc.push_back(mean_at(series.temperature_degc, k));
    }
  }
  return means;
}

}  // namespace zerorate::diagnose

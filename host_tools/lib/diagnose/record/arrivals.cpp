#include "host_tools/lib/diagnose/record/arrivals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace zerorate::diagnose {
namespace {

constexpr double kFewestFilled = 0.7;
constexpr double kMostJitter = 0.125;   // share of a period; a later sample is a loss
constexpr std::size_t kConfirming = 7;  // samples, the late one included
constexpr double kNoGrid = 0.15;        // rms distance of stamps that lie on no grid; 0.29 at most

/// The mean of the intervals that are about one median interval.
double mean_period(const Record& record) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t k = 1; k < record.size(); ++k) {
    const double interval = record.time_s[k] - record.time_s[k - 1];
    if (std::abs(interval - record.sample_period_s) > 0.5 * record.sample_period_s) continue;
    sum += interval;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : record.sample_period_s;
}

/// rms distance of the intervals from whole periods.
double interval_jitter(const Record& record, double period_s) {
  double squares = 0.0;
  for (std::size_t k = 1; k < record.size(); ++k) {
    const double periods = (record.time_s[k] - record.time_s[k - 1]) / period_s;
    const double off = periods - std::max(1.0, std::round(periods));
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(record.size() - 1));
}

/// Follows the grid from sample to sample.
class GridPhase {
 public:
  GridPhase(const Record& record, double period_s, bool is_jittery)
      : record_(record), period_s_(period_s), confirmed_(is_jittery ? kConfirming : 1U) {}

  /// Periods from the sample before to this one: 1 where nothing is lost.
  std::size_t step_to(std::size_t k) {
    const double due_s = phase_s_ + period_s_;
    // Before a loss most of those that confirm may be late already, and this one not.
    const bool is_late = record_.time_s[k] - due_s > 0.5 * period_s_;
    const double most_are = std::round(lateness(k, due_s));
    const double late = is_late ? std::max(0.0, most_are) : std::min(0.0, most_are);
    // Two samples may share a place.
    const double steps = std::max(0.0, 1.0 + late);
    phase_s_ += steps * period_s_;
    // Clocks drift, holes are long: the phase comes from the latest stamps.
    constexpr double kFollow = 0.1;
    const double off_s = record_.time_s[k] - phase_s_;
    phase_s_ +=
        confirmed_ == 1 ? off_s : kFollow * std::clamp(off_s, -0.5 * period_s_, 0.5 * period_s_);
    return static_cast<std::size_t>(steps);
  }
  void start(double time_s) { phase_s_ = time_s; }

 private:
  /// In periods; the middle one of this sample and those that confirm it.
  [[nodiscard]] double lateness(std::size_t k, double due_s) const {
    std::array<double, kConfirming> late{};
    const std::size_t count = std::min(confirmed_, record_.size() - k);
    for (std::size_t j = 0; j < count; ++j) {
      late[j] = (record_.time_s[k + j] - due_s) / period_s_ - static_cast<double>(j);
    }
    std::sort(late.begin(), late.begin() + static_cast<std::ptrdiff_t>(count));
    return late[count / 2];
  }

  const Record& record_;
  double period_s_;
  std::size_t confirmed_;
  double phase_s_ = 0.0;
};

void measure_gaps(const Record& record, Losses& losses) {
  const double span_s = record.time_s.back() - record.time_s.front();
  const double long_s = Losses::kLongGap * span_s / static_cast<double>(record.size() - 1);
  losses.runs = 0;
  for (std::size_t k = 1; k < record.size(); ++k) {
    const double interval = record.time_s[k] - record.time_s[k - 1];
    if (interval <= long_s) continue;
    ++losses.runs;
    losses.gaps_s += interval;
  }
}

}  // namespace

Arrivals place_samples(const Record& record) {
  Arrivals arrivals{.period_s = mean_period(record)};
  Losses& losses = arrivals.losses;
  losses.jitter = interval_jitter(record, arrivals.period_s) / std::sqrt(2.0);
  GridPhase phase(record, arrivals.period_s, losses.jitter > kMostJitter);
  phase.start(record.time_s.front());
  arrivals.places.reserve(record.size());
  arrivals.places.push_back(0);
  for (std::size_t k = 1; k < record.size(); ++k) {
    const std::size_t step = phase.step_to(k);
    arrivals.places.push_back(arrivals.places.back() + step);
    if (step <= 1) continue;
    losses.lost += step - 1;
    ++losses.runs;
  }
  losses.expected = record.size() + losses.lost;
  losses.is_uneven = static_cast<double>(losses.lost) >
                     (1.0 - kFewestFilled) * static_cast<double>(losses.expected);
  losses.in_bursts = losses.is_uneven && losses.jitter * std::sqrt(2.0) > kNoGrid;
  if (losses.in_bursts) {
    losses.expected = losses.lost = 0;
    measure_gaps(record, losses);
  }
  return arrivals;
}

namespace {

constexpr std::size_t kFewest = 5;
constexpr double kOverChance = 4.0;
constexpr double kMostOfOneValue = 0.2;  // share of the repetitions
constexpr double kNear = 0.05;           // share of the differences that count as about zero
constexpr double kCoarse = 0.25;         // largest step of a level over the middle difference
constexpr double kRounding = 1e-5;       // share of the middle difference, by single precision

/// Differences of neighbours that differ, without sign, ascending.
std::vector<double> differences_of(const std::vector<double>& rates) {
  std::vector<double> differences;
  differences.reserve(rates.size());
  for (std::size_t k = 1; k < rates.size(); ++k) {
    if (rates[k] != rates[k - 1]) differences.push_back(std::abs(rates[k] - rates[k - 1]));
  }
  std::ranges::sort(differences);
  return differences;
}

/// The most differences that are one number, to rounding. Levels survive here where a bias was
/// subtracted that changes now and then: neighbours still differ by a whole number of steps.
double most_of_one_difference(const std::vector<double>& ascending) {
  const double width = kRounding * ascending[ascending.size() / 2];
  std::ptrdiff_t most = 0;
  auto end = ascending.begin();
  for (auto first = ascending.begin(); first != ascending.end(); ++first) {
    while (end != ascending.end() && *end - *first <= width) ++end;
    most = std::max(most, end - first);
  }
  return static_cast<double>(most);
}

/// How many neighbours would be equal by chance: as many as differ by the least difference, one
/// way, and no fewer than those that differ by any one number. All of them where the levels are too
/// coarse for an estimate.
double equal_by_chance(const std::vector<double>& rates) {
  const std::vector<double> differences = differences_of(rates);
  const auto all = static_cast<double>(rates.size());
  if (differences.empty()) return all;
  const auto quantile = [&](double share) {
    return differences[static_cast<std::size_t>(share * static_cast<double>(differences.size()))];
  };
  const double least = differences.front();
  if (least > kCoarse * quantile(0.5)) return all;
  const double width = quantile(kNear);
  const auto within =
      static_cast<double>(std::ranges::upper_bound(differences, width) - differences.begin());
  return std::max(0.5 * within * least / width, 0.5 * most_of_one_difference(differences));
}

double most_of_one_value(std::vector<double> values) {
  std::ranges::sort(values);
  std::ptrdiff_t most = 0;
  for (auto first = values.begin(); first != values.end();) {
    const auto end = std::upper_bound(first, values.end(), *first);
    most = std::max(most, end - first);
    first = end;
  }
  return static_cast<double>(most);
}

}  // namespace

std::vector<std::size_t> find_repeated_samples(const Record& record) {
  const std::vector<double>& rates = record.rate_rad_s;
  std::vector<std::size_t> repeated;
  std::vector<double> values;
  for (std::size_t k = 1; k < rates.size(); ++k) {
    if (rates[k] != rates[k - 1]) continue;
    repeated.push_back(k);
    values.push_back(rates[k]);
  }
  const auto count = static_cast<double>(repeated.size());
  const bool is_chance = repeated.size() < kFewest || count <= kOverChance * equal_by_chance(rates);
  if (is_chance || most_of_one_value(std::move(values)) > kMostOfOneValue * count) return {};
  return repeated;
}

Record without_samples(const Record& record, const std::vector<std::size_t>& left_out) {
  Record rest = record;
  const auto thin = [&](std::vector<double>& values) {
    if (values.empty()) return;
    std::size_t kept = 0;
    auto next = left_out.begin();
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (next != left_out.end() && *next == k) {
        ++next;
        continue;
      }
      values[kept++] = values[k];
    }
    values.resize(kept);
  };
  thin(rest.time_s);
  thin(rest.rate_rad_s);
  thin(rest.temperature_degc);
  return rest;
}

}  // namespace zerorate::diagnose

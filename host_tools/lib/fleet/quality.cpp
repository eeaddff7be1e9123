#include "host_tools/lib/fleet/quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>
#include <utility>

#include "host_tools/lib/fleet/population.hpp"
#include "host_tools/lib/fleet/presentation.hpp"
#include "host_tools/lib/statistics/half_width.hpp"

namespace zerorate::fleet {
namespace {

constexpr std::size_t kFewestSensors = 3;

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Standard deviation about the means of the lots, and the number of lots.
std::pair<double, std::size_t> spread_in_lots(std::span<const double> values,
                                              std::span<const std::size_t> lots) {
  const std::size_t count = lots.empty() ? 0 : *std::ranges::max_element(lots) + 1;
  std::vector<double> sums(count);
  std::vector<double> sizes(count);
  for (std::size_t i = 0; i < values.size(); ++i) {
    sums[lots[i]] += values[i];
    sizes[lots[i]] += 1.0;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double off = values[i] - sums[lots[i]] / sizes[lots[i]];
    squares += off * off;
  }
  const auto used = static_cast<std::size_t>(
      std::ranges::count_if(sizes, [](double size) { return size > 0.0; }));
  const double freedom = static_cast<double>(values.size()) - static_cast<double>(used);
  return {freedom > 0.0 ? std::sqrt(squares / freedom) : 0.0, used};
}

/// Bissell (1990), eq. 3.
Index index_of(double mean, double spread, const Range& limits, std::size_t sensors) {
  const double value = std::min(limits.hi - mean, mean - limits.lo) / (3.0 * spread);
  const auto n = static_cast<double>(sensors);
  const double half =
      statistics::kHalfWidth95 * std::sqrt(1.0 / (9.0 * n) + value * value / (2.0 * (n - 1.0)));
  return {value, value - half, value + half};
}

/// Limits of a coordinate: those of N and B are logarithms here.
std::optional<Range> range_of_coordinate(const Limits& limits, int coordinate) {
  const std::array ranges{limits.angle_random_walk_rad_per_sqrt_s, limits.bias_instability_rad_s,
                          limits.order};
  std::optional<Range> range = ranges[static_cast<std::size_t>(coordinate)];
  if (!range || !shown()[static_cast<std::size_t>(coordinate)].is_log) return range;
  const auto log_of = [](double value) {
    return value > 0.0 ? std::log(value) : -std::numeric_limits<double>::infinity();
  };
  return Range{log_of(range->lo), log_of(range->hi)};
}

const AxisResult& result_of(const Population& population, const Member& member) {
  const auto& axes = population.recordings[member.recording].result.axes;
  return *std::ranges::find(axes, member.axis, &AxisResult::axis);
}

Judgement worse(Judgement one, Judgement other) {
  if (one == Judgement::fail || other == Judgement::fail) return Judgement::fail;
  return one == Judgement::pass ? other : one;
}

Judgement judge_axis(const Population& population, const Member& member, const Limits& limits) {
  const AxisResult& axis = result_of(population, member);
  Judgement all = Judgement::pass;
  for (int coordinate = 0; coordinate < kCoordinates; ++coordinate) {
    const Profile& profile = member.profiles[static_cast<std::size_t>(coordinate)];
    const auto range = range_of_coordinate(limits, coordinate);
    if (range) all = worse(all, judge({profile.lo, profile.hi}, *range));
  }
  if (const auto& rates = limits.mean_rate_rad_s) {
    all = worse(all, judge({axis.mean_rate_rad_s, axis.mean_rate_rad_s}, *rates));
  }
  const bool has_cause =
      std::ranges::any_of(axis.causes, [&](const Cause& cause) { return fails_by(cause, limits); });
  return has_cause ? Judgement::fail : all;
}

/// Judges a recording apart from its axes: one of them may be missing, or all too short.
Judgement judge_recording(const RecordingResult& recording, std::size_t axes,
                          const Limits& limits) {
  if (recording.axes.size() < axes) return Judgement::fail;
  return recording.rest_s < limits.shortest_s ? Judgement::too_short : Judgement::pass;
}

void judge_sensors(const Population& population, const Limits& limits, Quality& quality) {
  std::size_t most_axes = 0;
  for (const StoredRecording& one : population.recordings) {
    most_axes = std::max(most_axes, one.result.axes.size());
  }
  std::vector<Judgement> judgements(population.sensors.size(), Judgement::pass);
  for (const Member& member : population.members) {
    const RecordingResult& recording = population.recordings[member.recording].result;
    Judgement& one = judgements[member.sensor];
    one = worse(one, judge_axis(population, member, limits));
    one = worse(one, judge_recording(recording, most_axes, limits));
  }
  const auto count = [&](Judgement which) {
    return static_cast<std::size_t>(std::ranges::count(judgements, which));
  };
  quality.has_limits = true;
  quality.passed = count(Judgement::pass);
  quality.failed = count(Judgement::fail);
  quality.too_short = count(Judgement::too_short);
  quality.yield = share_of(quality.passed, judgements.size());
}

bool is_digit(char c) {
  return '0' <= c && c <= '9';
}

/// The number that a name begins with, or its first letter.
std::string_view first_part(std::string_view name) {
  const auto* const end = std::ranges::find_if_not(name, is_digit);
  return name.substr(0, std::max<std::size_t>(static_cast<std::size_t>(end - name.begin()), 1));
}

/// Below, above or equal to 0 as a number of any length is smaller, larger or the same.
int compare_numbers(std::string_view one, std::string_view other) {
  for (std::string_view* const number : {&one, &other}) {
    number->remove_prefix(std::min(number->find_first_not_of('0'), number->size()));
  }
  if (one.size() != other.size()) return one.size() < other.size() ? -1 : 1;
  return one.compare(other);
}

QualityFigure figure_of(const Population& population, const Limits* limits, int coordinate,
                        const std::vector<std::size_t>& order) {
  QualityFigure figure{.key = shown()[static_cast<std::size_t>(coordinate)].key};
  std::vector<double> values;
  std::vector<std::size_t> lots;
  std::vector<double> sums(population.sensors.size());
  std::vector<double> axes(population.sensors.size());
  for (const Member& member : population.members) {
    values.push_back(member.profiles[static_cast<std::size_t>(coordinate)].best);
    lots.push_back(member.lot);
    sums[member.sensor] += values.back();
    axes[member.sensor] += 1.0;
  }
  for (const std::size_t sensor : order) figure.values.push_back(sums[sensor] / axes[sensor]);
  if (figure.values.size() > 1) figure.chart = control_chart_of(figure.values);
  const auto range =
      limits != nullptr ? range_of_coordinate(*limits, coordinate) : std::optional<Range>{};
  figure.limits = range;
  if (range) figure.capability = capability_of(values, lots, order.size(), *range);
  return figure;
}

}  // namespace

std::optional<Capability> capability_of(std::span<const double> values,
                                        std::span<const std::size_t> lots, std::size_t sensors,
                                        const Range& limits) {
  if (sensors < kFewestSensors || !(std::isfinite(limits.lo) || std::isfinite(limits.hi))) {
    return std::nullopt;
  }
  Capability result{.mean = mean_of(values)};
  double squares = 0.0;
  for (const double value : values) {
    squares += (value - result.mean) * (value - result.mean);
    if (value < limits.lo) ++result.below;
    if (value > limits.hi) ++result.above;
  }
  result.spread = std::sqrt(squares / (static_cast<double>(values.size()) - 1.0));
  if (!(result.spread > 0.0)) return std::nullopt;
  result.ppk = index_of(result.mean, result.spread, limits, sensors);
  const auto [within, count] = spread_in_lots(values, lots);
  if (count > 1 && within > 0.0) {
    result.lot_spread = within;
    result.cpk = index_of(result.mean, within, limits, sensors);
  }
  return result;
}

Index share_of(std::size_t k, std::size_t n) {
  if (n == 0) return {0.0, 0.0, 1.0};
  const auto count = static_cast<double>(n);
  const double share = static_cast<double>(k) / count;
  const double z2 = statistics::kHalfWidth95 * statistics::kHalfWidth95 / count;
  const double middle = (share + 0.5 * z2) / (1.0 + z2);
  const double half = std::sqrt(z2 * (share * (1.0 - share) + 0.25 * z2)) / (1.0 + z2);
  return {share, std::max(middle - half, 0.0), std::min(middle + half, 1.0)};
}

ControlChart control_chart_of(std::span<const double> values) {
  constexpr double kStepOfSigma = 1.128;  // mean size of the difference of two normal values
  double steps = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) steps += std::abs(values[i] - values[i - 1]);
  const double sigma = steps / static_cast<double>(values.size() - 1) / kStepOfSigma;
  ControlChart chart{.centre = mean_of(values)};
  chart.lo = chart.centre - 3.0 * sigma;
  chart.hi = chart.centre + 3.0 * sigma;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] < chart.lo || values[i] > chart.hi) chart.outside.push_back(i);
  }
  return chart;
}

bool comes_before(std::string_view one, std::string_view other) {
  std::string_view left = one;
  std::string_view its_left = other;
  while (!left.empty() && !its_left.empty()) {
    const std::string_view own = first_part(left);
    const std::string_view its = first_part(its_left);
    const bool are_numbers = is_digit(own.front()) && is_digit(its.front());
    if (const int order = are_numbers ? compare_numbers(own, its) : own.compare(its); order != 0) {
      return order < 0;
    }
    left.remove_prefix(own.size());
    its_left.remove_prefix(its.size());
  }
  if (left.size() != its_left.size()) return left.size() < its_left.size();
  return one < other;  // 01 and 1
}

Quality quality_of(const Population& population, const Limits* limits) {
  Quality quality;
  for (std::size_t i = 0; i < population.sensors.size(); ++i) quality.order.push_back(i);
  std::ranges::stable_sort(quality.order, [&](std::size_t i, std::size_t k) {
    const Sensor& one = population.sensors[i];
    const Sensor& other = population.sensors[k];
    if (one.lot == other.lot) return comes_before(one.name, other.name);
    return comes_before(population.lots[one.lot].name, population.lots[other.lot].name);
  });
  for (int coordinate = 0; coordinate < kCoordinates; ++coordinate) {
    quality.figures.push_back(figure_of(population, limits, coordinate, quality.order));
  }
  if (limits != nullptr) judge_sensors(population, *limits, quality);
  return quality;
}

}  // namespace zerorate::fleet

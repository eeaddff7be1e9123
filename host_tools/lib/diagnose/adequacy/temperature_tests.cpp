#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/diagnose/adequacy/tails.hpp"
#include "host_tools/lib/diagnose/effects/mean_scan.hpp"

namespace zerorate::diagnose {
namespace {

/// Smooth enough for a derivative: means over a two-hundredth of the record.
std::vector<double> smoothed(const std::vector<double>& values) {
  const std::size_t n = values.size();
  const std::size_t half = std::max<std::size_t>(1, n / 400);
  std::vector<double> sums(n + 1);
  for (std::size_t k = 0; k < n; ++k) sums[k + 1] = sums[k] + values[k];
  std::vector<double> result(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t first = k > half ? k - half : 0;
    const std::size_t end = std::min(n, k + half + 1);
    result[k] = (sums[end] - sums[first]) / static_cast<double>(end - first);
  }
  return result;
}

std::vector<double> rate_of_change(const std::vector<double>& smooth) {
  const std::size_t n = smooth.size();
  const std::size_t half = std::max<std::size_t>(1, n / 400);
  std::vector<double> rate(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t first = k > half ? k - half : 0;
    const std::size_t end = std::min(n - 1, k + half);
    rate[k] = (smooth[end] - smooth[first]) / static_cast<double>(end - first);
  }
  return rate;
}

/// Follows with a lag, given in values.
std::vector<double> lagged(const std::vector<double>& values, double lag) {
  const double follow = -std::expm1(-1.0 / lag);
  std::vector<double> result(values.size());
  double state = values.front();
  for (std::size_t k = 0; k < values.size(); ++k) result[k] = state += follow * (values[k] - state);
  return result;
}

/// What remains within `width` of the temperature before it is moved: play, as of a gear.
std::vector<double> played(const std::vector<double>& values, double width) {
  std::vector<double> result(values.size());
  double state = values.front();
  for (std::size_t k = 0; k < values.size(); ++k) {
    result[k] = state = std::clamp(state, values[k] - width, values[k] + width);
  }
  return result;
}

std::vector<double> power_of(const std::vector<double>& values, double exponent) {
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  std::vector<double> result(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    result[k] = std::pow(values[k] - mean, exponent);
  }
  return result;
}

std::vector<double> signs_of(const std::vector<double>& values) {
  std::vector<double> result(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    result[k] = values[k] > 0.0 ? 1.0 : values[k] < 0.0 ? -1.0 : 0.0;
  }
  return result;
}

}  // namespace

Tests test_temperature(const Remainder& remainder) {
  const Problem& problem = remainder.explanation->problem();
  const std::vector<double>& all = problem.series().temperature_degc;
  if (all.empty()) return {};
  const std::vector<double> temperature(all.begin(),
                                        all.begin() + static_cast<std::ptrdiff_t>(problem.size()));
  const auto [least, most] = std::ranges::minmax(temperature);
  constexpr double kLeastRange = 0.1;  // K
  if (most - least < kLeastRange) return {};
  const std::vector<double> smooth = smoothed(temperature);
  const std::vector<double> rate = rate_of_change(smooth);
  const MeanScan scan(*remainder.explanation);
  Tests tests;
  const auto test = [&](const char* words, std::initializer_list<std::vector<double>> functions) {
    std::vector<Column> columns;
    columns.reserve(functions.size());
    for (const auto& function : functions)
      columns.push_back(column_of(problem, std::span(function)));
    tests.push_back({words, log_chi_squared_tail(2.0 * scan.gain(columns),
                                                 static_cast<double>(columns.size()))});
  };
  const double range = most - least;
  const auto size = static_cast<double>(problem.size());
  test("the bias depends on the temperature, not by a line or a square",
       {power_of(smooth, 1.0), power_of(smooth, 2.0), power_of(smooth, 3.0)});
  test("the bias depends on how fast the temperature changes", {rate, power_of(rate, 2.0)});
  test("the bias is another while heating than while cooling", {signs_of(rate)});
  test("the bias depends on temperatures of the past",
       {lagged(smooth, size / 100.0), lagged(smooth, size / 10.0)});
  test("the bias has hysteresis in temperature",
       {played(smooth, 0.1 * range), played(smooth, 0.25 * range)});
  return tests;
}

}  // namespace zerorate::diagnose

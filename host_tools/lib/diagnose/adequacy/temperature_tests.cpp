#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"
#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

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

/// Play, as of a gear: stays within `width` of the temperature, and is moved when it leaves that.
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

/// Functions of the temperature's past that come back to themselves: play of several widths, and
/// the direction.
std::vector<Column> hysteresis_columns(const FitData& data, const std::vector<double>& smooth,
                                       const std::vector<double>& rate) {
  const auto [least, most] = std::ranges::minmax(smooth);
  std::vector<Column> columns;
  for (const double share : {0.02, 0.04, 0.08, 0.12, 0.16, 0.2, 0.25, 0.3, 0.36, 0.42}) {
    columns.push_back(
        column_of(data, std::span<const double>(played(smooth, share * (most - least)))));
  }
  columns.push_back(column_of(data, std::span<const double>(signs_of(rate))));
  return columns;
}

/// log of the integral of sqrt(p q) over all records, p and q being what two hypotheses say of
/// them.
double log_affinity(const Hypothesis& one, const Hypothesis& other) {
  const std::vector<double>& p = one.density();
  const std::vector<double>& q = other.density();
  double sum = 0.0;
  for (std::size_t k = 1; k < one.residual().size(); ++k) {
    const double mean = one.residual()[k] - other.residual()[k];
    const double both = p[k] + q[k];
    sum += 0.25 * std::log(4.0 * p[k] * q[k] / (both * both)) - 0.25 * mean * mean / both;
  }
  return sum;
}

/// Slow noise takes in what is left of a hysteresis, and nothing of it remains to be seen. So one
/// such function is put in the noise's place, and the temperature itself if it is not there. Where
/// that is more likely, how likely is it under the noise? Chernoff's bound: a likelihood ratio of
/// e^t has the probability E sqrt(ratio) e^(-t/2). The amplitudes are averaged over as wide as they
/// are: sqrt(1 + 2 G) each.
void test_hysteresis_for_noise(const Hypothesis& noisy, const std::vector<double>& smooth,
                               const std::vector<double>& rate, Tests& tests) {
  std::vector<Part> parts;
  std::ranges::copy_if(noisy.parts(), std::back_inserter(parts),
                       [](const Part& part) { return !part.terms.has_slow_noise(); });
  if (parts.size() == noisy.parts().size()) return;
  const FitData& data = noisy.data();
  const Hypothesis without(data, parts, &noisy);
  const std::vector<Column> functions = hysteresis_columns(data, smooth, rate);
  Part part{.effect = "hysteresis"};
  const bool is_followed = std::ranges::any_of(
      parts, [](const Part& other) { return other.effect == "temperature_drift"; });
  if (!is_followed) part.columns.push_back(column_of(data, std::span<const double>(smooth)));
  part.columns.emplace_back();
  std::optional<MeanFit> hysteresis = fit_mean(without, [&](const ColumnSearch& scan) {
    double most = -1.0;
    Part best = part;
    for (const Column& function : functions) {
      part.columns.back() = function;
      const double gain = scan.gain(part.columns);
      if (gain <= most) continue;
      most = gain;
      best = part;
    }
    return std::optional(std::move(best));
  });
  const double gain = hysteresis->gain_nats;
  const double ahead = gain - (noisy.log_likelihood() - without.log_likelihood());
  double log_p = 0.0;
  if (ahead > 0.0) {
    const auto amplitudes = static_cast<double>(hysteresis->part.columns.size());
    const double averaged = 0.5 * amplitudes * std::log1p(2.0 * gain);
    parts.push_back(std::move(hysteresis->part));
    log_p = std::log(static_cast<double>(functions.size())) + averaged - 0.5 * ahead +
            log_affinity(noisy, Hypothesis(data, std::move(parts), &without));
  }
  tests.push_back(
      {"what looks like slow noise is hysteresis in temperature", std::min(0.0, log_p)});
}

}  // namespace

Tests test_temperature(const StandardisedResidual& residual) {
  const FitData& data = residual.hypothesis->data();
  const std::vector<double>& all = data.series().temperature_degc;
  if (all.empty()) return {};
  const std::vector<double> temperature(all.begin(),
                                        all.begin() + static_cast<std::ptrdiff_t>(data.size()));
  const auto [least, most] = std::ranges::minmax(temperature);
  constexpr double kLeastRange = 0.1;  // K
  if (most - least < kLeastRange) return {};
  const std::vector<double> smooth = smoothed(temperature);
  const std::vector<double> rate = rate_of_change(smooth);
  const ColumnSearch scan(*residual.hypothesis);
  Tests tests;
  const auto test = [&](const char* words, std::initializer_list<std::vector<double>> functions) {
    std::vector<Column> columns;
    columns.reserve(functions.size());
    for (const auto& function : functions) columns.push_back(column_of(data, std::span(function)));
    tests.push_back({words, statistics::log_chi_squared_tail(2.0 * scan.gain(columns),
                                                             static_cast<double>(columns.size()))});
  };
  const double range = most - least;
  const auto size = static_cast<double>(data.size());
  test("the bias depends on the temperature, not by a line or a square",
       {power_of(smooth, 1.0), power_of(smooth, 2.0), power_of(smooth, 3.0)});
  test("the bias depends on how fast the temperature changes", {rate, power_of(rate, 2.0)});
  test("the bias is another while heating than while cooling", {signs_of(rate)});
  test("the bias depends on temperatures of the past",
       {lagged(smooth, size / 100.0), lagged(smooth, size / 10.0)});
  test("the bias has hysteresis in temperature",
       {played(smooth, 0.1 * range), played(smooth, 0.25 * range)});
  test_hysteresis_for_noise(*residual.hypothesis, smooth, rate, tests);
  return tests;
}

}  // namespace zerorate::diagnose

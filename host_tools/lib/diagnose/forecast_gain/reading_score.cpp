#include "host_tools/lib/diagnose/forecast_gain/reading_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastProbability = 1e-300;

struct Interval {
  double from;
  double to;
};

/// One of the things that the sample may be: normal, with the share that it has of all.
struct Component {
  double share;
  double mean;
  double variance;

  [[nodiscard]] double density(double rate) const {
    const double off = rate - mean;
    return share * std::exp(-0.5 * off * off / variance) /
           std::sqrt(2.0 * std::numbers::pi * variance);
  }
  [[nodiscard]] double mass(const Interval& interval) const {
    const double unit = std::sqrt(2.0 * variance);
    double from = (interval.from - mean) / unit;
    double to = (interval.to - mean) / unit;
    if (from < 0.0 && to < 0.0) {  // in the upper tail nothing cancels
      std::swap(from, to);
      from = -from;
      to = -to;
    }
    return share * 0.5 * (std::erfc(from) - std::erfc(to));
  }
};

/// Sum of the density over the levels, times the step: 1 unless the levels are far apart.
double sum_over_levels(const std::array<Component, 3>& parts, double level, double step) {
  const double sigma = std::sqrt(parts.front().variance);
  if (step < sigma) return 1.0;  // exact to 1e-8
  constexpr double kReach = 8.0;
  const double middle = std::round((parts.front().mean - level) / step);
  const double reach = std::ceil(kReach * sigma / step);
  double sum = 0.0;
  for (double n = middle - reach; n <= middle + reach; n += 1.0) {
    for (const Component& part : parts) sum += step * part.density(level + n * step);
  }
  return std::max(sum, kLeastProbability);
}

/// @param rounding  variance that is not noise but of rounding, less than there is
std::array<Component, 3> components(const core::SampleScreen::Forecast& forecast, double rounding) {
  const double mean = double{forecast.expected_rad_s};
  const double all = double{forecast.variance};
  const double narrow = all - rounding;
  const double moved = double{forecast.moved};
  const double outlier = (1.0 - moved) * double{forecast.outlier};
  return {
      {{1.0 - moved - outlier, mean, narrow},
       {outlier, mean, narrow + double{forecast.outlier_variance}},
       {moved, mean + double{forecast.offset_rad_s}, narrow + double{forecast.offset_variance}}}};
}

}  // namespace

double log_score(const core::SampleScreen::Forecast& forecast, double reading_rad_s,
                 const Scale& scale) {
  const double half = 0.5 * scale.step_rad_s;
  auto parts = components(forecast, scale.rounding_variance);
  if (half > 0.0) {
    Component& undisturbed = parts.front();
    const double step = scale.step_rad_s;
    const statistics::MeanBeforeRounding mean_before_rounding(std::sqrt(undisturbed.variance) /
                                                              step);
    undisturbed.mean =
        reading_rad_s + step * mean_before_rounding((undisturbed.mean - reading_rad_s) / step);
  }
  double sum = 0.0;
  if (!scale.range.is_saturated(static_cast<float>(reading_rad_s)) && half == 0.0) {
    for (const Component& part : parts) sum += part.density(reading_rad_s);
    const double levels = sum_over_levels(parts, reading_rad_s, scale.unknown_step_rad_s);
    return std::log(std::max(sum, kLeastProbability) / levels);
  }
  Interval cell{reading_rad_s - half, reading_rad_s + half};
  if (reading_rad_s >= double{scale.range.upper_rad_s}) cell.to = kInfinity;
  if (reading_rad_s <= double{scale.range.lower_rad_s}) cell.from = -kInfinity;
  for (const Component& part : parts) sum += part.mass(cell);
  const double width = half > 0.0 ? scale.step_rad_s : scale.end_cell_rad_s;
  return std::log(std::max(sum, kLeastProbability) / width);
}

}  // namespace zerorate::diagnose

#include "host_tools/lib/identify/near_zero_mean.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using units::kDegPerRad;

struct Level {
  double mean_rad_s = 0.0;
  double scatter_rad_s = 0.0;  ///< standard deviation of the means of tenths
  /// Allan variance over a 20th of the recording over that of white noise, by a 200th.
  double slow_noise = 0.0;
};

/// Rates in succession, or means of as many of them each [rad/s].
using Series = std::vector<double>;

Series series_of(const RestSamples& samples, std::size_t axis) {
  Series series;
  series.reserve(samples.rate_rad_s.size());
  for (const auto& rate_rad_s : samples.rate_rad_s) series.push_back(double{rate_rad_s[axis]});
  return series;
}

std::vector<Series> series_of(const RestSamples& samples) {
  std::vector<Series> axes;
  for (std::size_t i = 0; i < samples.axis_count; ++i) axes.push_back(series_of(samples, i));
  return axes;
}

/// Means of equal parts in succession [rad/s].
std::vector<double> means_of_parts(const Series& series, std::size_t parts) {
  const std::size_t size = series.size();
  std::vector<double> means(parts);
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t first = part * size / parts;
    const std::size_t end = (part + 1) * size / parts;
    for (std::size_t k = first; k < end; ++k) means[part] += series[k];
    means[part] /= static_cast<double>(end - first);
  }
  return means;
}

/// Overlapped Allan variance of means of so many parts.
double allan_variance(const std::vector<double>& parts, std::size_t together) {
  std::vector<double> sums{0.0};
  for (const double part : parts) sums.push_back(sums.back() + part);
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 2 * together; k < sums.size(); ++k, ++count) {
    const double difference = (sums[k] - 2.0 * sums[k - together] + sums[k - 2 * together]) /
                              static_cast<double>(together);
    squares += difference * difference;
  }
  return 0.5 * squares / static_cast<double>(count);
}

std::optional<Level> level_of(const Series& series) {
  constexpr std::size_t kParts = 200;
  constexpr std::size_t kTogether = 10;
  constexpr std::size_t kTenths = 10;
  if (series.size() < kParts) return std::nullopt;
  const std::vector<double> parts = means_of_parts(series, kParts);
  const double by_white_noise = allan_variance(parts, 1) / kTogether;
  double sum = 0.0;
  double squares = 0.0;
  for (const double tenth : means_of_parts(series, kTenths)) {
    sum += tenth;
    squares += tenth * tenth;
  }
  const double mean = sum / kTenths;
  return Level{
      .mean_rad_s = mean,
      .scatter_rad_s = std::sqrt(std::max(0.0, squares - kTenths * mean * mean) / (kTenths - 1)),
      .slow_noise = by_white_noise > 0.0 ? allan_variance(parts, kTogether) / by_white_noise : 1.0};
}

/// The level of an axis whose mean is near zero.
std::optional<Level> near_zero(const Series& series) {
  constexpr double kShare = 0.5;
  constexpr double kDrift_rad_s = 0.05 / kDegPerRad;
  const std::optional<Level> level = level_of(series);
  const bool is_near = level && std::abs(level->mean_rad_s) < kShare * level->scatter_rad_s &&
                       level->scatter_rad_s <= kDrift_rad_s;
  return is_near ? level : std::nullopt;
}

/// Means of as many ratios of white noise exceed one limit, and stay below the other, with a
/// probability of 0.999 (30,000 records of 200 values).
struct Limits {
  double least;
  double most;
};
constexpr std::array kOfWhiteNoise{Limits{0.38, 2.31}, Limits{0.52, 1.84}, Limits{0.60, 1.67}};

struct AxisLevel {
  std::size_t axis = 0;
  Level level;
};

/// Axes whose bias was taken out, with their levels.
std::vector<AxisLevel> levels_without_bias(const std::vector<Series>& axes) {
  std::vector<AxisLevel> levels;
  double slow_noise = 0.0;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    const std::optional<Level> level = near_zero(axes[axis]);
    if (!level) continue;
    levels.push_back({axis, *level});
    slow_noise += level->slow_noise;
  }
  if (levels.empty()) return levels;
  slow_noise /= static_cast<double>(levels.size());
  const Limits limits = kOfWhiteNoise.at(levels.size() - 1);
  const bool is_missing = slow_noise < limits.least;
  const bool is_held_down = levels.size() == kOfWhiteNoise.size() && slow_noise > limits.most;
  if (!is_missing && !is_held_down) levels.clear();
  return levels;
}

RestDoubt doubt_of(const std::string& axes, const Level& level) {
  return {doubt::kBias,
          fmt::format("the mean of {} is {:.2g} deg/s, and means of tenths of the recording "
                      "scatter by {:.2g} deg/s: a bias already taken out upstream? Slow noise went "
                      "with it, and a node needs the rates of the chip",
                      axes, level.mean_rad_s * kDegPerRad, level.scatter_rad_s * kDegPerRad),
          false};
}

std::vector<RestDoubt> doubts_of(const std::vector<Series>& axes) {
  const std::vector<AxisLevel> levels = levels_without_bias(axes);
  if (levels.size() == axes.size() && axes.size() > 1) {
    const auto size = [](const AxisLevel& one) { return std::abs(one.level.mean_rad_s); };
    return {doubt_of("every axis is near zero, the largest",
                     std::ranges::max_element(levels, {}, size)->level)};
  }
  std::vector<RestDoubt> doubts;
  for (const AxisLevel& one : levels) {
    const std::string name = axes.size() == 1 ? "rate" : std::string(1, "xyz"[one.axis]);
    doubts.push_back(doubt_of("axis " + name, one.level));
    doubts.back().axis = one.axis;
  }
  return doubts;
}

}  // namespace

std::vector<std::size_t> axes_without_bias(const RestSamples& samples) {
  std::vector<std::size_t> axes;
  for (const AxisLevel& one : levels_without_bias(series_of(samples))) axes.push_back(one.axis);
  return axes;
}

std::optional<std::string> remark_on_mean(const RestSamples& samples, std::size_t axis) {
  const std::optional<Level> level = near_zero(series_of(samples, axis));
  if (!level) return std::nullopt;
  const std::vector<AxisLevel> in_doubt = levels_without_bias(series_of(samples));
  if (std::ranges::find(in_doubt, axis, &AxisLevel::axis) != in_doubt.end()) return std::nullopt;
  return fmt::format(
      "The mean is {:.2g} deg/s, and means of tenths of the recording scatter by {:.2g} deg/s: was "
      "a bias already taken out? A node needs the rates of the chip.",
      level->mean_rad_s * kDegPerRad, level->scatter_rad_s * kDegPerRad);
}

std::vector<RestDoubt> doubts_of_bias_taken_out(const RestSamples& samples) {
  return doubts_of(series_of(samples));
}

LevelCheck::LevelCheck(std::size_t axis_count) : means_(axis_count), sums_(axis_count) {}

void LevelCheck::add(const std::array<float, recording::kMaxAxes>& rate_rad_s) {
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += double{rate_rad_s[i]};
  if (++summed_ < together_) return;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    means_[i].push_back(sums_[i] / static_cast<double>(together_));
    sums_[i] = 0.0;
  }
  summed_ = 0;
  if (means_.front().size() == kMostMeans) halve();
}

void LevelCheck::halve() {
  for (Series& means : means_) {
    for (std::size_t k = 0; k < kMostMeans / 2; ++k) {
      means[k] = 0.5 * (means[2 * k] + means[2 * k + 1]);
    }
    means.resize(kMostMeans / 2);
  }
  together_ *= 2;
}

std::vector<RestDoubt> LevelCheck::doubts() const {
  return doubts_of(means_);
}

}  // namespace zerorate::identify

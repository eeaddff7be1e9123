#include "host_tools/lib/identify/rest_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/order_statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using units::kDegPerRad;
using units::kRadPerDeg;

/// Standard deviation of a sample's white noise by the median change between neighbours, which a
/// minority of moving samples leaves as it is.
double white_sigma(const RestSamples& samples, std::size_t axis) {
  constexpr double kSigmaPerMedian = 1.0 / 0.6744897501960817;  // of a normal distribution
  std::vector<double> changes;
  changes.reserve(samples.time.size());
  for (std::size_t k = 1; k < samples.time.size(); ++k) {
    changes.push_back(
        std::abs(double{samples.rate_rad_s[k][axis]} - double{samples.rate_rad_s[k - 1][axis]}));
  }
  return statistics::median_of(std::move(changes)) * kSigmaPerMedian / std::sqrt(2.0);
}

/// How an axis was turned.
struct Turning {
  double share = 0.0;           ///< of the half-second means
  double furthest_rad_s = 0.0;  ///< of the means that moved, from the median
};

Turning turning_of(const RestSamples& samples, const std::vector<TickMean>& ticks,
                   std::size_t axis) {
  constexpr double kLargestChange_rad_s = 1.0 * kRadPerDeg;
  constexpr double kFurthest_rad_s = 15.0 * kRadPerDeg;
  constexpr double kSigmas = 8.0;
  std::vector<double> means;
  means.reserve(ticks.size());
  for (const TickMean& tick : ticks) means.push_back(double{tick.rate_rad_s[axis]});
  const double median = statistics::median_of(means);
  const double a_tick =
      static_cast<double>(samples.time.size()) / static_cast<double>(ticks.size());
  const double noise = white_sigma(samples, axis) * std::sqrt(2.0 / a_tick);
  const double largest_change = std::max(kLargestChange_rad_s, kSigmas * noise);
  Turning turning;
  std::size_t moved = 0;
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double away = std::abs(means[i] - median);
    const bool changes =
        (i > 0 && std::abs(means[i] - means[i - 1]) > largest_change) ||
        (i + 1 < means.size() && std::abs(means[i + 1] - means[i]) > largest_change);
    if (!changes && away <= kFurthest_rad_s) continue;
    ++moved;
    turning.furthest_rad_s = std::max(turning.furthest_rad_s, away);
  }
  turning.share = static_cast<double>(moved) / static_cast<double>(means.size());
  return turning;
}

std::optional<RestDoubt> doubt_of_motion(const RestSamples& samples) {
  constexpr std::size_t kFewest = 20;
  constexpr double kFewestMoved = 3.5;  // a single step or outlier moves two or three
  constexpr double kCertainShare = 0.05;
  const core::Duration tick = std::max(core::Duration::milliseconds(500), samples.sample_period);
  const std::vector<TickMean> ticks = average_ticks(samples, tick);
  if (ticks.size() < kFewest) return std::nullopt;
  Turning most;
  std::size_t axis_of_most = 0;
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    const Turning turning = turning_of(samples, ticks, axis);
    if (turning.share <= most.share) continue;
    most = turning;
    axis_of_most = axis;
  }
  if (most.share * static_cast<double>(ticks.size()) < kFewestMoved) return std::nullopt;
  return RestDoubt{
      fmt::format(
          "the sensor was turned: axis {} moved in {:.2g} % of the time, by up to {:.3g} deg/s. "
          "Say when it stood: a still, odometer_pulses or speed column, or --still-from gyro",
          samples.axis_name(axis_of_most), 100.0 * most.share, most.furthest_rad_s * kDegPerRad),
      most.share > kCertainShare};
}

/// Whether every rate of an axis is a whole number of the unit, several of them different.
bool holds_counts(const RestSamples& samples, std::size_t axis, double unit_rad_s) {
  constexpr double kNearlyWhole = 1e-3;
  double least = samples.rate_rad_s.front()[axis];
  double most = least;
  for (const auto& rates : samples.rate_rad_s) {
    const double number = double{rates[axis]} / unit_rad_s;
    if (std::abs(number - std::round(number)) > kNearlyWhole) return false;
    least = std::min(least, double{rates[axis]});
    most = std::max(most, double{rates[axis]});
  }
  return most - least > 2.5 * unit_rad_s;
}

std::optional<RestDoubt> doubt_of_counts(const RestSamples& samples) {
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    for (const double unit : {kRadPerDeg, 1.0}) {
      if (!holds_counts(samples, axis, unit)) continue;
      return RestDoubt{
          fmt::format("every rate of axis {} is a whole number of {}: raw counts of the chip? Give "
                      "their factor: "
                      "--columns gx=NAME,... --units rate=0.00875dps",
                      samples.axis_name(axis), unit == 1.0 ? "rad/s" : "deg/s")};
    }
  }
  return std::nullopt;
}

std::optional<RestDoubt> doubt_of_unit(const RestSamples& samples) {
  constexpr double kNoisiest = 2.0;   // deg/s/sqrt(Hz); consumer gyros have 0.003 to 0.06
  constexpr double kQuietest = 2e-4;  // the best MEMS gyros have 0.001
  const double root_period = std::sqrt(static_cast<double>(samples.mean_period.ns()) * 1e-9);
  double quietest = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    const double noise = white_sigma(samples, axis) * root_period * kDegPerRad;
    if (noise > kNoisiest) {
      return RestDoubt{fmt::format(
          "the noise of axis {} is {:.3g} deg/s/sqrt(Hz), and no gyro at rest has more than {:g}: "
          "degrees named radians, raw counts, or a sensor in motion? --columns and --units name "
          "another unit",
          samples.axis_name(axis), noise, kNoisiest)};
    }
    if (noise > 0.0) quietest = std::min(quietest, noise);
  }
  if (quietest >= kQuietest || !std::isfinite(quietest)) return std::nullopt;
  return RestDoubt{
      fmt::format("the noise is {:.2g} deg/s/sqrt(Hz), less than a fifth of the best MEMS "
                  "gyro's: radians named degrees? --columns and --units name another unit",
                  quietest),
      false};
}

}  // namespace

std::vector<RestDoubt> doubts_of_rest(const RestSamples& samples) {
  std::vector<RestDoubt> doubts;
  for (const auto& look : {doubt_of_counts, doubt_of_unit, doubt_of_motion}) {
    if (auto doubt = look(samples)) doubts.push_back(std::move(*doubt));
  }
  return doubts;
}

std::vector<std::string> require_rest(const RestSamples& samples) {
  std::vector<std::string> remarks;
  for (RestDoubt& doubt : doubts_of_rest(samples)) {
    if (doubt.is_certain) throw recording::DataError(doubt.sentence);
    remarks.push_back(std::move(doubt.sentence));
  }
  return remarks;
}

}  // namespace zerorate::identify

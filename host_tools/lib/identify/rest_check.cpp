#include "host_tools/lib/identify/rest_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
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

constexpr std::size_t kBlock = 60'000;      // samples
constexpr std::size_t kMostBlocks = 1'000;  // whose white noise is remembered
constexpr std::array kWholeUnits_rad_s{kRadPerDeg, 1.0};

bool is_whole_number(double number) {
  constexpr double kNearlyWhole = 1e-3;
  return std::abs(number - std::round(number)) <= kNearlyWhole;
}

}  // namespace

RestCheck::RestCheck(std::size_t axis_count, core::Duration sample_period,
                     core::Duration mean_period)
    : block_{.axis_count = axis_count, .sample_period = sample_period, .mean_period = mean_period} {
}

void RestCheck::add(core::Instant at, const std::array<float, recording::kMaxAxes>& rate_rad_s) {
  block_.time.push_back(at);
  block_.rate_rad_s.push_back(rate_rad_s);
  if (block_.time.size() >= kBlock) end_block();
}

void RestCheck::end_block() {
  constexpr std::size_t kFewestOfBlock = 20;
  const core::Duration tick = std::max(core::Duration::milliseconds(500), block_.sample_period);
  const std::vector<TickMean> ticks = average_ticks(block_, tick);
  const bool is_long_enough = ticks.size() >= kFewestOfBlock;
  if (is_long_enough) ticks_ += ticks.size();
  for (std::size_t axis = 0; axis < block_.axis_count; ++axis) {
    look_at_samples(axis);
    if (is_long_enough) look_for_motion(axis, ticks);
  }
  block_.time.clear();
  block_.rate_rad_s.clear();
}

void RestCheck::look_at_samples(std::size_t axis) {
  Axis& seen = axes_[axis];
  for (const auto& rates : block_.rate_rad_s) {
    const double rate = rates[axis];
    seen.least = std::min(seen.least, rate);
    seen.most = std::max(seen.most, rate);
    for (std::size_t i = 0; i < kWholeUnits_rad_s.size(); ++i) {
      seen.is_whole[i] = seen.is_whole[i] && is_whole_number(rate / kWholeUnits_rad_s[i]);
    }
  }
  if (block_.time.size() < 2 || seen.white_sigmas.size() >= kMostBlocks) return;
  seen.white_sigmas.push_back(white_sigma(block_, axis));
}

void RestCheck::look_for_motion(std::size_t axis, const std::vector<TickMean>& ticks) {
  constexpr double kLargestChange_rad_s = 1.0 * kRadPerDeg;
  constexpr double kFurthest_rad_s = 15.0 * kRadPerDeg;
  constexpr double kSigmas = 8.0;
  Axis& seen = axes_[axis];
  std::vector<double> means;
  means.reserve(ticks.size());
  for (const TickMean& tick : ticks) means.push_back(double{tick.rate_rad_s[axis]});
  if (!seen.reference_rad_s) seen.reference_rad_s = statistics::median_of(means);
  const double a_tick = static_cast<double>(block_.time.size()) / static_cast<double>(ticks.size());
  const double largest_change =
      std::max(kLargestChange_rad_s, kSigmas * white_sigma(block_, axis) * std::sqrt(2.0 / a_tick));
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double away = std::abs(means[i] - *seen.reference_rad_s);
    const bool changes =
        (i > 0 && std::abs(means[i] - means[i - 1]) > largest_change) ||
        (i + 1 < means.size() && std::abs(means[i + 1] - means[i]) > largest_change);
    if (!changes && away <= kFurthest_rad_s) continue;
    ++seen.moved;
    seen.furthest_rad_s = std::max(seen.furthest_rad_s, away);
  }
}

std::optional<RestDoubt> RestCheck::doubt_of_motion() const {
  constexpr std::size_t kFewestMoved = 4;  // a single step or outlier moves two or three
  constexpr double kCertainShare = 0.05;
  std::size_t most = 0;
  for (std::size_t axis = 1; axis < block_.axis_count; ++axis) {
    if (axes_[axis].moved > axes_[most].moved) most = axis;
  }
  const Axis& turned = axes_[most];
  if (turned.moved < kFewestMoved) return std::nullopt;
  const double share = static_cast<double>(turned.moved) / static_cast<double>(ticks_);
  return RestDoubt{
      fmt::format(
          "the sensor was turned: axis {} moved in {:.2g} % of the time, by up to {:.3g} deg/s. "
          "Say when it stood: a still, odometer_pulses or speed column, or --still-from gyro",
          name(most), 100.0 * share, turned.furthest_rad_s * kDegPerRad),
      share > kCertainShare};
}

std::optional<RestDoubt> RestCheck::doubt_of_counts() const {
  for (std::size_t axis = 0; axis < block_.axis_count; ++axis) {
    for (std::size_t i = 0; i < kWholeUnits_rad_s.size(); ++i) {
      const Axis& seen = axes_[axis];
      // Several different ones: a constant may be anything.
      if (!seen.is_whole[i] || !(seen.most - seen.least > 2.5 * kWholeUnits_rad_s[i])) continue;
      return RestDoubt{
          fmt::format("every rate of axis {} is a whole number of {}: raw counts of the chip? Give "
                      "their factor: --columns gx=NAME,... --units rate=0.00875dps",
                      name(axis), i == 0 ? "deg/s" : "rad/s")};
    }
  }
  return std::nullopt;
}

std::optional<RestDoubt> RestCheck::doubt_of_unit() const {
  constexpr double kNoisiest = 2.0;   // deg/s/sqrt(Hz); consumer gyros have 0.003 to 0.06
  constexpr double kQuietest = 2e-4;  // the best MEMS gyros have 0.001
  const double root_period = std::sqrt(static_cast<double>(block_.mean_period.ns()) * 1e-9);
  double quietest = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < block_.axis_count; ++axis) {
    if (axes_[axis].white_sigmas.empty()) continue;
    const double noise = statistics::median_of(axes_[axis].white_sigmas) * root_period * kDegPerRad;
    if (noise > kNoisiest) {
      return RestDoubt{fmt::format(
          "the noise of axis {} is {:.3g} deg/s/sqrt(Hz), and no gyro at rest has more than {:g}: "
          "degrees named radians, raw counts, or a sensor in motion? --columns and --units name "
          "another unit",
          name(axis), noise, kNoisiest)};
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

std::vector<RestDoubt> RestCheck::doubts() {
  if (!block_.time.empty()) end_block();
  std::vector<RestDoubt> doubts;
  for (auto doubt : {doubt_of_counts(), doubt_of_unit(), doubt_of_motion()}) {
    if (doubt) doubts.push_back(std::move(*doubt));
  }
  return doubts;
}

std::vector<RestDoubt> doubts_of_rest(const RestSamples& samples) {
  RestCheck check{samples.axis_count, samples.sample_period, samples.mean_period};
  for (std::size_t i = 0; i < samples.time.size(); ++i) {
    check.add(samples.time[i], samples.rate_rad_s[i]);
  }
  return check.doubts();
}

std::vector<std::string> require_rest(std::vector<RestDoubt> doubts) {
  std::vector<std::string> remarks;
  for (RestDoubt& doubt : doubts) {
    if (doubt.is_certain) throw recording::DataError(doubt.sentence);
    remarks.push_back(std::move(doubt.sentence));
  }
  return remarks;
}

std::vector<std::string> require_rest(const RestSamples& samples) {
  return require_rest(doubts_of_rest(samples));
}

}  // namespace zerorate::identify

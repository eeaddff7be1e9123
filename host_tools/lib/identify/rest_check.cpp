#include "host_tools/lib/identify/rest_check.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/monitor/odometer_check.hpp"
#include "core/standstill/calm_judge.hpp"
#include "host_tools/lib/identify/frozen_axes.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/sigma_of_changes.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {

namespace {

using units::kDegPerRad;
using units::kRadPerDeg;

/// Standard deviation of a sample's white noise, also where a minority of the samples moved.
double white_sigma(const RestSamples& samples, std::size_t axis) {
  std::vector<double> rates;
  rates.reserve(samples.time.size());
  for (const auto& rate_rad_s : samples.rate_rad_s) rates.push_back(double{rate_rad_s[axis]});
  return statistics::sigma_of_changes(rates);
}

constexpr std::size_t kBlock = 60'000;      // samples
constexpr std::size_t kMostBlocks = 1'000;  // blocks whose white noise is remembered
constexpr std::array kWholeUnits_rad_s{kRadPerDeg, 1.0};

bool is_whole_number(double number) {
  constexpr double kNearlyWhole = 1e-3;
  return std::abs(number - std::round(number)) <= kNearlyWhole;
}

}  // namespace

RestCheck::RestCheck(std::size_t axis_count, core::Duration sample_period,
                     core::Duration mean_period, bool is_separated)
    : block_{.axis_count = axis_count, .sample_period = sample_period, .mean_period = mean_period},
      is_separated_(is_separated) {}

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
      doubt::kMotion,
      fmt::format(
          "the sensor was turned: axis {} moved in {:.2g} % of the time, by up to {:.3g} deg/s. {}",
          name(most), 100.0 * share, turned.furthest_rad_s * kDegPerRad,
          is_separated_ ? "The rows that were left out are not all in which it moved: cut the "
                          "recording to its rest, or mark the rest in a still column"
                        : "Say when it stood: a still, odometer_pulses or speed column, or "
                          "--still-from gyro"),
      share > kCertainShare};
}

std::optional<RestDoubt> RestCheck::doubt_of_counts() const {
  for (std::size_t axis = 0; axis < block_.axis_count; ++axis) {
    for (std::size_t i = 0; i < kWholeUnits_rad_s.size(); ++i) {
      const Axis& seen = axes_[axis];
      // Several different ones: a constant may be anything.
      if (!seen.is_whole[i] || !(seen.most - seen.least > 2.5 * kWholeUnits_rad_s[i])) continue;
      return RestDoubt{
          doubt::kCounts,
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
  // Consumer gyros have up to 0.06 deg/s/sqrt(Hz), noisy ones of wide range levels up to 75 deg/s.
  constexpr double kNoisy = 0.1;
  constexpr double kFurthest = 15.0;
  const double root_period = std::sqrt(static_cast<double>(block_.mean_period.ns()) * 1e-9);
  double quietest = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < block_.axis_count; ++axis) {
    if (axes_[axis].white_sigmas.empty()) continue;
    const double noise = statistics::median_of(axes_[axis].white_sigmas) * root_period * kDegPerRad;
    const double level = std::abs(axes_[axis].reference_rad_s.value_or(0.0)) * kDegPerRad;
    if (noise > kNoisiest) {
      return RestDoubt{doubt::kUnit, fmt::format("the noise of axis {} is {:.3g} deg/s/sqrt(Hz), "
                                                 "and no gyro at rest has more than {:g}: "
                                                 "degrees named radians, raw counts, or a sensor "
                                                 "in motion? --columns and --units name "
                                                 "another unit",
                                                 name(axis), noise, kNoisiest)};
    }
    if (noise > kNoisy && level > kFurthest) {
      return RestDoubt{
          doubt::kUnit,
          fmt::format(
              "axis {} has a level of {:.3g} deg/s and noise of {:.3g} deg/s/sqrt(Hz), both "
              "beyond those of gyros: degrees named radians? --columns and --units name "
              "another unit",
              name(axis), level, noise)};
    }
    if (noise > 0.0) quietest = std::min(quietest, noise);
  }
  if (quietest >= kQuietest || !std::isfinite(quietest)) return std::nullopt;
  return RestDoubt{
      doubt::kUnit,
      fmt::format("the noise is {:.2g} deg/s/sqrt(Hz), less than a fifth of the best MEMS "
                  "gyro's: radians named degrees, or the angle of each sample? --columns and "
                  "--units name another unit, as --units rate=deg/sample",
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

namespace {

using Judge = core::CalmJudge<recording::kMaxAxes>;

/// A tick of the node, and the samples that it is the mean of.
struct JudgedTick {
  TickMean mean;
  std::size_t first = 0;
  std::size_t end = 0;
  bool moved = false;
};

/// White variance of a sample by the differences of neighbours, over all axes.
float mean_variance(const RestSamples& samples) {
  const auto variances = variances_of_differences(samples);
  const double sum = std::accumulate(variances.begin(), variances.end(), 0.0);
  return static_cast<float>(sum / static_cast<double>(samples.axis_count));
}

/// Bias of a stop as its calm ticks show it: a steady turn has no spread, but lies apart.
class StopBias {
 public:
  void end_stop() { ticks_ = 0; }
  void add(const TickMean& mean) {
    if (ticks_++ == 0) bias_rad_s_ = {};
    for (std::size_t i = 0; i < bias_rad_s_.size(); ++i) {
      bias_rad_s_[i] += (mean.rate_rad_s[i] - bias_rad_s_[i]) / static_cast<float>(ticks_);
    }
  }
  /// nullptr before two seconds are known.
  [[nodiscard]] const Judge::Rates* known() const {
    constexpr int kTicks = 4;
    return ticks_ < kTicks ? nullptr : &bias_rad_s_;
  }

 private:
  Judge::Rates bias_rad_s_{};
  int ticks_ = 0;
};

std::vector<JudgedTick> judge_ticks(const RestSamples& samples, core::StandstillSource source) {
  const core::Duration tick = std::max(core::Duration::milliseconds(500), samples.sample_period);
  core::TickAverage<recording::kMaxAxes> average{tick, samples.sample_period};
  Judge judge{source, core::OdometerCheckParams{}.longest_bend, tick};
  core::WhiteLevel<recording::kMaxAxes> white{mean_variance(samples), {}, tick, true};
  StopBias bias;
  std::vector<JudgedTick> ticks;
  std::size_t first = 0;
  const auto close = [&](std::size_t end) {
    if (average.is_empty()) return;
    ticks.push_back({.mean = average.close(), .first = first, .end = end});
    first = end;
    const core::Calm calm = judge.judge(ticks.back().mean, {}, bias.known(), 0.0F, white);
    ticks.back().moved = calm != core::Calm::calm;
    if (calm == core::Calm::calm) {
      bias.add(ticks.back().mean);
      white.observe(ticks.back().mean);
    }
    if (calm != core::Calm::moved) return;
    const std::uint32_t newest = ticks.back().mean.tick;
    for (auto one = ticks.rbegin();
         one != ticks.rend() && one->mean.tick + judge.reach_ticks() > newest; ++one) {
      one->moved = true;
    }
  };
  auto next_departure = samples.after_drives.begin();
  for (std::size_t k = 0; k < samples.time.size(); ++k) {
    const bool departs = next_departure != samples.after_drives.end() && *next_departure == k;
    if (departs || average.is_over_at(samples.time[k])) close(k);
    if (departs) {
      judge.end_stop();
      bias.end_stop();
      ++next_departure;
    }
    average.enter(samples.time[k]);
    average.add(samples.time[k], samples.rate_rad_s[k]);
    judge.add(samples.rate_rad_s[k]);
  }
  close(samples.time.size());
  return ticks;
}

std::vector<double> turning_of(const std::vector<JudgedTick>& ticks, std::size_t axis_count) {
  std::vector<double> turning;
  for (std::size_t i = 0; i < axis_count; ++i) {
    std::vector<double> calm;
    for (const JudgedTick& tick : ticks) {
      if (!tick.moved) calm.push_back(double{tick.mean.rate_rad_s[i]});
    }
    if (calm.empty()) return {};
    const double bias = statistics::median_of(std::move(calm));
    std::size_t moved = 0;
    for (const JudgedTick& tick : ticks) {
      if (!tick.moved) continue;
      if (i == 0) turning.push_back(0.0);
      double& most = turning[moved++];
      most = std::max(most, std::abs(double{tick.mean.rate_rad_s[i]} - bias));
    }
  }
  std::ranges::sort(turning);
  return turning;
}

}  // namespace

double MotionAtRest::share() const {
  return static_cast<double>(std::ranges::count(moved, true)) / static_cast<double>(moved.size());
}

MotionAtRest find_motion(const RestSamples& samples, core::StandstillSource source) {
  const std::vector<JudgedTick> ticks = judge_ticks(samples, source);
  MotionAtRest motion{.moved = std::vector<bool>(samples.time.size(), false),
                      .stops = samples.after_drives.size() + 1};
  std::vector<bool> stop_has_motion(motion.stops, false);
  for (const JudgedTick& tick : ticks) {
    if (!tick.moved) continue;
    for (std::size_t k = tick.first; k < tick.end; ++k) motion.moved[k] = true;
    const auto stop = std::ranges::upper_bound(samples.after_drives, tick.first);
    stop_has_motion[static_cast<std::size_t>(stop - samples.after_drives.begin())] = true;
  }
  motion.stops_with_motion = static_cast<std::size_t>(std::ranges::count(stop_has_motion, true));
  motion.turning_rad_s = turning_of(ticks, samples.axis_count);
  return motion;
}

void leave_out_motion(RestSamples& samples, const MotionAtRest& motion) {
  RestSamples calm = samples;
  calm.time.clear();
  calm.rate_rad_s.clear();
  calm.temperature_degc.clear();
  calm.acceleration_m_s2.clear();
  calm.after_drives.clear();
  bool is_after_motion = false;
  for (std::size_t k = 0; k < samples.time.size(); ++k) {
    is_after_motion |= std::ranges::binary_search(samples.after_drives, k);
    if (motion.moved[k]) {
      is_after_motion = true;
      ++calm.moving;
      continue;
    }
    if (is_after_motion && !calm.time.empty()) calm.after_drives.push_back(calm.time.size());
    is_after_motion = false;
    calm.time.push_back(samples.time[k]);
    calm.rate_rad_s.push_back(samples.rate_rad_s[k]);
    if (!samples.temperature_degc.empty()) {
      calm.temperature_degc.push_back(samples.temperature_degc[k]);
    }
    if (!samples.acceleration_m_s2.empty()) {
      calm.acceleration_m_s2.push_back(samples.acceleration_m_s2[k]);
    }
  }
  samples = std::move(calm);
}

core::StandstillSource rest_source(std::string_view name) {
  if (name == "odometer") return core::StandstillSource::odometer;
  if (name == "gyro") return core::StandstillSource::gyro;
  if (name == "odometer-alone") return core::StandstillSource::odometer_alone;
  throw std::invalid_argument(
      fmt::format("rest: expected odometer, gyro or odometer-alone, found {}", name));
}

RestSamples read_rest(recording::Reader& reader, core::StandstillSource source,
                      const RestOptions& options) {
  if (source != core::StandstillSource::gyro) return read_rest_samples(reader, options);
  RestOptions all = options;
  all.has_no_odometer = true;
  RestSamples samples = read_rest_samples(reader, all);
  leave_out_motion(samples, find_motion(samples, source));
  return samples;
}

}  // namespace zerorate::identify

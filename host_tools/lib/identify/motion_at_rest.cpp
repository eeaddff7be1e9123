#include "host_tools/lib/identify/motion_at_rest.hpp"

#include <algorithm>
#include <cmath>

#include "core/monitor/odometer_check.hpp"
#include "core/standstill/calm_judge.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {
namespace {

static_assert(recording::kMaxAxes == core::CalmJudge::kAxes);

/// A tick of the node, and the samples that it is the mean of.
struct JudgedTick {
  TickMean mean;
  std::size_t first = 0;
  std::size_t end = 0;
  bool moved = false;
};

/// White variance of a sample by the differences of neighbours, over all axes.
float variance_of_differences(const RestSamples& samples) {
  double sum = 0.0;
  for (std::size_t k = 1; k < samples.time.size(); ++k) {
    for (std::size_t i = 0; i < samples.axis_count; ++i) {
      const double change = samples.rate_rad_s[k][i] - samples.rate_rad_s[k - 1][i];
      sum += 0.5 * change * change;
    }
  }
  return static_cast<float>(sum / static_cast<double>(samples.time.size() * samples.axis_count));
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
  [[nodiscard]] const core::CalmJudge::Rates* known() const {
    constexpr int kTicks = 4;
    return ticks_ < kTicks ? nullptr : &bias_rad_s_;
  }

 private:
  core::CalmJudge::Rates bias_rad_s_{};
  int ticks_ = 0;
};

std::vector<JudgedTick> judge_ticks(const RestSamples& samples, core::StandstillSource source) {
  const core::Duration tick = std::max(core::Duration::milliseconds(500), samples.sample_period);
  core::TickAverage<recording::kMaxAxes> average{tick, samples.sample_period};
  core::CalmJudge judge{source, core::OdometerCheck::Params{}.longest_bend, tick,
                        variance_of_differences(samples)};
  StopBias bias;
  std::vector<JudgedTick> ticks;
  std::size_t first = 0;
  const auto close = [&](std::size_t end) {
    if (average.is_empty()) return;
    ticks.push_back({.mean = average.close(), .first = first, .end = end});
    first = end;
    const core::Calm calm = judge.judge(ticks.back().mean, bias.known(), 0.0F);
    ticks.back().moved = calm != core::Calm::calm;
    if (calm == core::Calm::calm) bias.add(ticks.back().mean);
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
  }
  samples = std::move(calm);
}

RestSamples read_rest(recording::Reader& reader, core::StandstillSource source,
                      const RestOptions& options) {
  RestSamples samples = read_rest_samples(reader, options);
  if (source == core::StandstillSource::gyro) {
    leave_out_motion(samples, find_motion(samples, source));
  }
  return samples;
}

}  // namespace zerorate::identify

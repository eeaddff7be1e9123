#include "host_tools/lib/evaluate/replay_trace.hpp"

namespace zerorate::evaluate {
namespace {

void accumulate(TracePoint& sum, const TracePoint& point, double weight) {
  sum.time_s += weight * point.time_s;
  sum.measured_dps += weight * point.measured_dps;
  sum.corrected_dps += weight * point.corrected_dps;
  sum.error_dps += weight * point.error_dps;
  sum.bias_dps += weight * point.bias_dps;
  sum.last_stop_mean_dps += weight * point.last_stop_mean_dps;
  sum.sigma_dps += weight * point.sigma_dps;
}

}  // namespace

void ReplayTrace::add(const ReplayedSample& sample) {
  const double time_s = static_cast<double>(sample.time_ns) * 1e-9;
  if (!started_) start_s_ = time_s;
  started_ = true;
  follow_learning(sample.learnt_ticks);
  if (sample.moving) {
    in_stop_ = false;
  } else if (in_stop_) {
    stops_.back().to_s = time_s;
  } else {
    in_stop_ = true;
    stops_.push_back({time_s, time_s});
  }
  if (!sample.message.has_rate()) return;
  const app::AxisRate& rate = sample.message.axes[axis_];
  const auto dps = [this](const std::array<float, 3>& rates_rad_s) {
    return double{core::rad_per_s(rates_rad_s[axis_]).in(core::deg_per_s)};
  };
  const double measured_dps = double{rate.measured.in(core::deg_per_s)};
  const TracePoint point{.time_s = time_s,
                         .measured_dps = measured_dps,
                         .corrected_dps = double{rate.corrected.in(core::deg_per_s)},
                         .error_dps = measured_dps - dps(sample.true_rate_rad_s),
                         .bias_dps = double{rate.bias.in(core::deg_per_s)},
                         .last_stop_mean_dps = dps(sample.last_stop_mean_rad_s),
                         .sigma_dps = double{rate.sigma.in(core::deg_per_s)},
                         .calibrated = sample.message.health.calibrated};
  // A stretch never mixes what was corrected with what could not be.
  if (filled_ > 0 && sum_.calibrated != point.calibrated) close_stretch();
  sum_.calibrated = point.calibrated;
  accumulate(sum_, point, 1.0);
  if (++filled_ == stretch_) close_stretch();
}

void ReplayTrace::add(const ReplayedDrive& drive) {
  if (drive.axis != axis_) return;
  const double start_s = static_cast<double>(drive.start_ns) * 1e-9;
  if (drives_.empty() || drives_.back().start_s != start_s) drives_.push_back({start_s, {}});
  drives_.back().outcomes[static_cast<std::size_t>(drive.predictor)] = drive.outcome;
}

void ReplayTrace::add(const LearntStop& stop) {
  models_.push_back(
      {static_cast<double>(stop.time_ns) * 1e-9, learnt_model(stop.axes[axis_], stop.mesh)});
}

/// A step lets few ticks go at once, those that were held back; what it leaps over further was a
/// drive.
void ReplayTrace::follow_learning(std::uint32_t learnt_ticks) {
  constexpr std::uint32_t kMostHeld = 16;
  const std::uint32_t before = learnt_.empty() ? 0 : learnt_.back().to;
  if (learnt_ticks <= before) return;
  if (!learnt_.empty() && learnt_ticks - before <= kMostHeld) {
    learnt_.back().to = learnt_ticks;
  } else {
    learnt_.push_back({learnt_ticks - 1, learnt_ticks});
  }
}

void ReplayTrace::close_stretch() {
  if (filled_ == 0) return;
  TracePoint mean{.calibrated = sum_.calibrated};
  accumulate(mean, sum_, 1.0 / static_cast<double>(filled_));
  points_.push_back(mean);
  sum_ = {};
  filled_ = 0;
  if (points_.size() == kMostPoints) merge_pairs();
}

void ReplayTrace::merge_pairs() {
  std::vector<TracePoint> merged;
  merged.reserve(points_.size());
  for (std::size_t i = 0; i < points_.size(); i += 2) {
    if (i + 1 == points_.size() || points_[i].calibrated != points_[i + 1].calibrated) {
      merged.push_back(points_[i]);
      --i;  // the next one starts a pair of its own
      continue;
    }
    TracePoint mean{.calibrated = points_[i].calibrated};
    accumulate(mean, points_[i], 0.5);
    accumulate(mean, points_[i + 1], 0.5);
    merged.push_back(mean);
  }
  points_ = std::move(merged);
  stretch_ *= 2;
}

}  // namespace zerorate::evaluate

/// @file
/// Scores of what a node predicts for the stops of a replay.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>

#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::evaluate {

/// Compares what a node predicts for a stop with what its first seconds then measure.
///
/// The bias moves on in a long stop, as in one in which a battery is charged: its mean is not what
/// the drive before it needed. As many ticks count as make the white noise of their mean half of
/// the sigma that the Kalman predictor states for the first of them, on the axis that needs most;
/// of a shorter stop all.
template <class Node>
class StopJudge {
 public:
  explicit StopJudge(const std::function<void(const ReplayedStop&)>& on_stop) : on_stop_(on_stop) {}

  /// Called before the node's first sample of the stop.
  void begin_stop(const Node& node) {
    (void)copy_learnt(node, before_);
    first_tick_.reset();
  }
  /// After each sample.
  void take(const Node& node, core::Instant start, ReplayResult& result) {
    if (!before_ || node.measured_ticks() <= before_->measured_ticks()) return;
    if (!first_tick_) {
      first_tick_ = node.measured_ticks() - 1;
      enough_ticks_ = ticks_asked(start, result.axis_count);
    }
    if (node.measured_ticks() - *first_tick_ >= enough_ticks_) judge(node, start, result);
  }
  /// After the drive that follows the stop, or at the end.
  void end_stop(const Node& running, core::Instant start, ReplayResult& result) {
    if (before_ && first_tick_) judge(running, start, result);
    before_.reset();
  }

 private:
  /// Compares with the calibration mean, which is the mean of the stop so far.
  void judge(const Node& running, core::Instant start, ReplayResult& result) {
    std::optional<Node> copy;
    const Node& node = copy_learnt(running, copy);
    const core::Duration tick = node.params().model.modes.tick;
    const core::Instant from = start + tick * std::int64_t{*first_tick_};
    const core::Instant to = start + tick * std::int64_t{node.measured_ticks()};
    const double length_s = (to - from).in_seconds();
    ReplayedStop stop;
    for (std::size_t i = 0; i < result.axis_count; ++i) {
      const double measured =
          double{node.bias(app::Predictor::calibration_mean, i).in(core::rad_per_s)};
      const double white = white_rad2_s(node, i) / length_s;
      stop.measured_rad_s[i] = measured;
      stop.error_rad_s[i].fill(std::numeric_limits<double>::quiet_NaN());
      for (std::size_t p = 0; p < app::kPredictors; ++p) {
        const auto predicted = before_->predict_heading(kAllPredictors[p], i, from, to);
        if (!predicted.is_available()) continue;
        const double variance = double{predicted.variance_rad2} / (length_s * length_s) + white;
        stop.error_rad_s[i][p] = measured - double{predicted.angle_rad} / length_s;
        stop.sigma_rad_s[i][p] = std::sqrt(variance);
        result.stop_scores[i][p].add(stop.error_rad_s[i][p], stop.sigma_rad_s[i][p], length_s);
      }
    }
    if (on_stop_) on_stop_(stop);
    before_.reset();
  }

  [[nodiscard]] std::uint32_t ticks_asked(core::Instant start, std::size_t axes) const {
    constexpr double kSharper = 4.0;  // in variance: half the sigma
    const core::Duration tick = before_->params().model.modes.tick;
    const core::Instant from = start + tick * std::int64_t{*first_tick_};
    const double tick_s = tick.in_seconds();
    double asked = 1.0;
    for (std::size_t i = 0; i < axes; ++i) {
      const auto first = before_->predict_heading(app::Predictor::kalman, i, from, from + tick);
      if (!first.is_available()) continue;
      const double variance = double{first.variance_rad2} / (tick_s * tick_s);
      asked = std::max(asked, std::ceil(kSharper * white_rad2_s(*before_, i) / variance / tick_s));
    }
    return static_cast<std::uint32_t>(std::min(asked, 1e9));
  }
  /// White noise of a mean over one second.
  [[nodiscard]] static double white_rad2_s(const Node& node, std::size_t axis) {
    return double{node.white_variance_rad2_s2(axis)} *
           double{node.params().model.sample_period.in_seconds()};
  }
  /// Copies the node with all that is certain learnt, wherever in the work of a tick it is.
  static const Node& copy_learnt(const Node& running, std::optional<Node>& copy) {
    copy.emplace(running.params());
    copy->restore(running.state());
    copy->finish_learning();
    return *copy;
  }
  const std::function<void(const ReplayedStop&)>& on_stop_;
  std::optional<Node> before_;               ///< node before the stop, until that is judged
  std::optional<std::uint32_t> first_tick_;  ///< first tick of the stop that was learnt from
  std::uint32_t enough_ticks_ = 0;           ///< from the first one on
};

}  // namespace zerorate::evaluate

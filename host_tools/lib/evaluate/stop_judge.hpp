/// @file
/// Scores of what a node predicts for the stops of a replay.
#pragma once

#include <algorithm>
#include <array>
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
/// the sigma that the Kalman predictor states for the first of them, on the axis that needs most. A
/// shorter stop counts as a whole. Fewer count where the temperature or another input of the model
/// moves the bias meanwhile, as in a stop with a charger: what was predicted holds for the inputs
/// before.
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
  /// @param message  that of the sample, with what inputs explain of the bias
  void take(const Node& node, core::Instant start, ReplayResult& result,
            const app::RateMessage& message) {
    if (!before_ || node.measured_ticks() <= before_->measured_ticks()) return;
    if (!first_tick_) {
      first_tick_ = node.measured_ticks() - 1;
      enough_ticks_ = ticks_asked(start, result.axis_count);
      explained_rad_s_ = explained_by(message);
    }
    if (node.measured_ticks() - *first_tick_ >= enough_ticks_ ||
        have_inputs_moved(message, result.axis_count)) {
      judge(node, start, result);
    }
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

  using Rates = std::array<double, 3>;

  /// Bias of each axis that the inputs of the model explain.
  static Rates explained_by(const app::RateMessage& message) {
    Rates all{};
    if (!message.explained) return all;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const app::ExplainedBias& one = (*message.explained)[i];
      const core::AngularRate sum = one.temperature + one.acceleration + one.vibration;
      all[i] = double{sum.in(core::rad_per_s)};
    }
    return all;
  }
  /// Whether the inputs have moved the bias of an axis by a good part of its sigma.
  [[nodiscard]] bool have_inputs_moved(const app::RateMessage& message, std::size_t axes) const {
    constexpr double kGoodPart = 0.5;  // half of it, on the mean of the time since
    const Rates now = explained_by(message);
    for (std::size_t i = 0; i < axes; ++i) {
      if (std::abs(now[i] - explained_rad_s_[i]) > kGoodPart * sigma_rad_s_[i]) return true;
    }
    return false;
  }

  [[nodiscard]] std::uint32_t ticks_asked(core::Instant start, std::size_t axes) {
    constexpr double kSharper = 4.0;  // in variance: half the sigma
    const core::Duration tick = before_->params().model.modes.tick;
    const core::Instant from = start + tick * std::int64_t{*first_tick_};
    const double tick_s = tick.in_seconds();
    double asked = 1.0;
    sigma_rad_s_.fill(std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < axes; ++i) {
      const auto first = before_->predict_heading(app::Predictor::kalman, i, from, from + tick);
      if (!first.is_available()) continue;
      const double variance = double{first.variance_rad2} / (tick_s * tick_s);
      sigma_rad_s_[i] = std::sqrt(variance);
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
  Rates explained_rad_s_{};                  ///< at the first tick
  Rates sigma_rad_s_{};                      ///< deviations of the bias predicted for it
};

}  // namespace zerorate::evaluate

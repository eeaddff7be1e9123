/// @file
/// Scores of what a node predicts for the stops of a replay.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::evaluate {

/// Compares what a node predicts for a stop with what the stop then measures.
template <class Node>
class StopJudge {
 public:
  /// Called before the node's first sample of the stop.
  void begin_stop(const Node& node) {
    (void)copy_learnt(node, before_);
    first_tick_.reset();
  }
  /// After each sample.
  void take(const Node& node) {
    if (!before_ || first_tick_ || node.measured_ticks() <= before_->measured_ticks()) return;
    first_tick_ = node.measured_ticks() - 1;
  }
  /// After the drive that follows the stop, or at the end: what the stop measured is the
  /// calibration mean.
  void end_stop(const Node& running, core::Instant start, ReplayResult& result) const {
    if (!before_ || !first_tick_) return;
    std::optional<Node> copy;
    const Node& node = copy_learnt(running, copy);
    const core::Duration tick = node.params().model.modes.tick;
    const core::Instant from = start + tick * std::int64_t{*first_tick_};
    const core::Instant to = start + tick * std::int64_t{node.measured_ticks()};
    const double length_s = (to - from).in_seconds();
    for (std::size_t i = 0; i < result.axis_count; ++i) {
      const double measured =
          double{node.bias(app::Predictor::calibration_mean, i).in(core::rad_per_s)};
      const double white = double{node.white_variance_rad2_s2(i)} *
                           double{node.params().model.sample_period.in_seconds()} / length_s;
      for (std::size_t p = 0; p < app::kPredictors; ++p) {
        const auto predicted = before_->predict_heading(kAllPredictors[p], i, from, to);
        if (!predicted.is_available()) continue;
        const double variance = double{predicted.variance_rad2} / (length_s * length_s) + white;
        result.stop_scores[i][p].add(measured - double{predicted.angle_rad} / length_s,
                                     std::sqrt(variance));
      }
    }
  }

 private:
  /// Copies the node with all that is certain learnt, wherever in the work of a tick it is.
  static const Node& copy_learnt(const Node& running, std::optional<Node>& copy) {
    copy.emplace(running.params());
    copy->restore(running.state());
    copy->finish_learning();
    return *copy;
  }
  std::optional<Node> before_;               ///< node before the stop
  std::optional<std::uint32_t> first_tick_;  ///< first tick of the stop that was learnt from
};

}  // namespace zerorate::evaluate

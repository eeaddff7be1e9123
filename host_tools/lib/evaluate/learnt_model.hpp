/// @file
/// Noise model that a node has learnt, in the units and with the intervals that people read.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "firmware/app/learnt_noise.hpp"

namespace zerorate::evaluate {

/// Figure with its 95 % interval.
struct LearntInterval {
  double value = 0.0;
  double lo = 0.0;
  double hi = 0.0;

  [[nodiscard]] bool contains(double x) const { return lo <= x && x <= hi; }
};

/// Figure and its interval with three digits, as in 0.62 (0.45 to 0.79).
[[nodiscard]] std::string in_words(const LearntInterval& figure);

/// Noise model of an axis.
struct LearntModel {
  LearntInterval order;                              ///< d
  LearntInterval bias_instability_dph;               ///< B
  LearntInterval angle_random_walk_dps_per_sqrt_hz;  ///< N [deg/s/sqrt(Hz)], two-sided
  double stops = 0.0;  ///< stops behind the figures, older ones counted in part
};

/// Converts what a node has learnt. The interval of the order is that of a normal distribution with
/// the node's mean and standard deviation; the intervals of B and N, which are positive, are those
/// of a log-normal one.
[[nodiscard]] LearntModel learnt_model(const app::LearntNoise& noise);

/// Object `learnt` of an axis of the schema zerorate.replay/1, described in
/// docs/reference/replay-json.md.
[[nodiscard]] nlohmann::ordered_json learnt_json(const LearntModel& learnt);

}  // namespace zerorate::evaluate

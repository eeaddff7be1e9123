/// @file
/// Noise model that a node has learnt, in the units and with the intervals that people read.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "firmware/app/learnt_noise.hpp"
#include "firmware/model/sensor_model.hpp"

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

/// Grid of noises that a node tries. Noises between two of them are not told apart.
struct LearntMesh {
  double order_step = 0.0;  ///< between neighbouring orders
  double lowest_order = 0.0;
  double highest_order = 1.0;       ///< random walks left out
  double log_amplitude_step = 0.0;  ///< step of ln B
  double lowest_ratio = 0.0;        ///< B over N at any order, SI units
  double highest_ratio = 0.0;       ///< likewise; 0: not known
};
/// Grid of a node with this model. A single order stands for the whole prior of the order.
[[nodiscard]] LearntMesh mesh_of(const model::SensorModel& model);

/// Noise model of an axis.
struct LearntModel {
  LearntInterval order;                              ///< d
  LearntInterval bias_instability_dph;               ///< B
  LearntInterval angle_random_walk_dps_per_sqrt_hz;  ///< N [deg/s/sqrt(Hz)], two-sided
  double stops = 0.0;  ///< stops behind the figures, older ones counted in part
  /// Whether the figure is that of the outermost noises which the node tries: the sensor may lie
  /// beyond.
  bool is_order_at_edge = false;
  bool is_bias_instability_at_edge = false;
};

/// Converts what a node has learnt. The interval of the order is that of a normal distribution with
/// the node's mean and standard deviation; the intervals of B and N, which are positive, are those
/// of a log-normal one. The variance of an even distribution over a cell of the mesh is added to
/// that of d and of ln B.
[[nodiscard]] LearntModel learnt_model(const app::LearntNoise& noise, const LearntMesh& mesh = {});
/// Sentence about figures at the edge of the mesh; empty where there are none.
[[nodiscard]] std::string edge_in_words(const LearntModel& learnt, const LearntMesh& mesh);

/// Object `learnt` of an axis of the schema zerorate.replay/1, described in
/// docs/reference/replay-json.md.
[[nodiscard]] nlohmann::ordered_json learnt_json(const LearntModel& learnt);

}  // namespace zerorate::evaluate

/// @file
/// Flicker noises that a sensor may have, around the model of its data sheet.
#pragma once

#include <vector>

#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

/// Largest number of hypotheses in a node.
inline constexpr int kMostHypotheses = 12;

/// A flicker noise with its prior probability.
struct FlickerHypothesis {
  Flicker flicker;
  /// Power over that of the model's flicker at the time constants of half a minute, where stops and
  /// drives are compared.
  double level = 1.0;
  double log_prior = 0.0;  ///< less a constant
};

/// Hypotheses of a model, on a grid of its prior: two orders d within one standard deviation of the
/// middle, by four and five amplitudes, and three random walks; or one order by four amplitudes
/// (docs/design/learning.md, section 1). None where the model has no flicker or learns nothing.
[[nodiscard]] std::vector<FlickerHypothesis> hypotheses_of(const SensorModel& model);

}  // namespace zerorate::model

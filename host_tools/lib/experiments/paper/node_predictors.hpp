/// @file
/// The node's own predictors (core/estimator, single precision) as participants.
#pragma once

#include <memory>

#include "core/noise/modes.hpp"
#include "host_tools/lib/experiments/paper/predictor.hpp"
#include "host_tools/lib/reference/fractional_noise.hpp"

namespace zerorate::experiments {

/// How the node approximates fractional noise: one first-order lag a decade, from a time constant
/// of one sample on.
struct DecadeNoise {
  reference::FractionalNoise noise;
  double sample_period_s = 1.0;
  int decades = 5;
  core::Start start = core::Start::zero;
};

/// The Kalman filter with one state a decade and the bias.
[[nodiscard]] std::unique_ptr<Predictor> make_decade_kalman(std::string name,
                                                            const DecadeNoise& noise,
                                                            const Lengths& lengths);
/// Eq. 8 and 9, with the interval of docs/design/window-intervals.md.
[[nodiscard]] std::unique_ptr<Predictor> make_moving_average(std::string name,
                                                             const DecadeNoise& noise,
                                                             const Lengths& lengths);
/// Eq. 9 alone, with its interval.
[[nodiscard]] std::unique_ptr<Predictor> make_calibration_mean(std::string name,
                                                               const DecadeNoise& noise,
                                                               const Lengths& lengths);

}  // namespace zerorate::experiments

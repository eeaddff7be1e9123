/// @file
/// Expected error of a linear predictor under a noise model, without simulation.
#pragma once

#include "host_tools/lib/experiments/paper/predictor.hpp"
#include "host_tools/lib/reference/fractional_noise.hpp"

namespace zerorate::experiments {

/// From the predictor's weights and the exact covariance of the noise: what the figures of a
/// Standing tend to with ever more sets.
struct Expectation {
  double std_ie = 0.0;
  double mean_rsse = 0.0;
  double std_rsse = 0.0;
  double coverage = 0.0;  ///< of two stated sigma

  [[nodiscard]] double mean_squared_rsse() const {
    return mean_rsse * mean_rsse + std_rsse * std_rsse;
  }
};

/// Time O(length^3); about a second for 1000 + 1000 samples.
/// @param predictor linear, with one sigma for all sets
[[nodiscard]] Expectation expect(const Predictor& predictor,
                                 const reference::FractionalNoise& noise, const Lengths& lengths);

}  // namespace zerorate::experiments

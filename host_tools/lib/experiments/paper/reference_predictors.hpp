/// @file
/// The predictors of host_tools/lib/reference as participants.
#pragma once

#include <memory>

#include "host_tools/lib/experiments/paper/predictor.hpp"
#include "host_tools/lib/reference/best_linear_predictor.hpp"
#include "host_tools/lib/reference/fractional_noise.hpp"

namespace zerorate::experiments {

/// The paper's filter: one state a sample, the calibration mean as its mean. Its own band takes
/// that mean as certain.
[[nodiscard]] std::unique_ptr<Predictor> make_full_state(std::string name,
                                                         const reference::FractionalNoise& noise,
                                                         const Lengths& lengths);

/// The optimum of all linear predictors.
[[nodiscard]] std::unique_ptr<Predictor> make_optimum(std::string name,
                                                      const reference::FractionalNoise& noise,
                                                      reference::Bias bias, const Lengths& lengths);

enum class AutoregressionFit { least_squares, burg };

/// A model fitted to each calibration anew, and its iterated forecast. Its own band takes the
/// fitted mean and coefficients as certain. The other one is that of the forecast's weights under
/// `noise`, with the weights as given although they come from the data.
[[nodiscard]] std::unique_ptr<Predictor> make_autoregression(
    std::string name, AutoregressionFit fit, std::size_t order,
    const reference::FractionalNoise& noise, const Lengths& lengths);

}  // namespace zerorate::experiments

/// @file
/// The optimum: no linear predictor has a smaller error under the model.
#pragma once

#include <cstddef>

#include "host_tools/lib/reference/fractional_noise.hpp"

namespace zerorate::reference {

/// Prior knowledge of the constant b before the calibration.
enum class Bias { diffuse, known };

/// The best linear unbiased predictor with b estimated by generalised least squares, or with b = 0
/// known. Row a of the weights and its Lagrange multiplier solve the kriging equations
///
///     | C + r I   1 | |   a    |   | c |
///     |   1'      0 | | lambda | = | 1 |
///
/// by LU factorisation (without the border when b is known); the error's variance is
/// c_0 - a'c - lambda. Time O((samples + leads) samples^2).
[[nodiscard]] LinearPredictor make_best_linear_predictor(const FractionalNoise& noise, Bias bias,
                                                         std::size_t samples, std::size_t leads);

}  // namespace zerorate::reference

/// @file
/// The optimum: no linear predictor has a smaller error under the model.
#pragma once

#include <Eigen/Core>
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

struct NormMoments {
  double mean;
  double standard_deviation;
};

/// Mean and standard deviation of |e| for Gaussian e of mean zero. With lambda the eigenvalues of
/// its covariance, E exp(-s |e|^2) = prod (1 + 2 s lambda)^(-1/2), and from
/// sqrt(q) = int_0^inf (1 - exp(-s q)) s^(-3/2) ds / (2 sqrt(pi))
///
///     E |e| = int_0^inf (1 - E exp(-s |e|^2)) s^(-3/2) ds / (2 sqrt(pi)),   E |e|^2 = trace.
///
/// Relative error below 1e-8. Time O(n^3) for the eigenvalues.
/// @param covariance n x n, symmetric, not zero
[[nodiscard]] NormMoments gaussian_norm(const Eigen::MatrixXd& covariance);

}  // namespace zerorate::reference

/// @file
/// The noise of the paper's simulation, by its exact covariance, and the best linear predictor of
/// it: a reference for predictors that approximate it. Double precision, dense matrices, no limit
/// on cost.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace zerorate::reference {

/// y_k = b + x_k + v_k: an unknown constant, ARFIMA(0,d,0) that starts from nothing at sample 0,
/// and white noise (Kirkko-Jaakkola et al. 2012, eq. 1 and 3). Any unit, the same for all.
struct FractionalNoise {
  double order = 0.5;                ///< d in (-1/2, 1]
  double innovation_variance = 1.0;  ///< s_f^2
  double white_variance = 0.0;       ///< r
};

/// psi_0 .. psi_{n-1}, the impulse response of (1 - L)^{-d}.
[[nodiscard]] Eigen::VectorXd impulse_response(double order, std::size_t n);

/// Covariance of x_0 .. x_{n-1} (without b and v), n x n, by the recursion along the diagonals
/// C_ij = C_{i-1,j-1} + s_f^2 psi_i psi_j. Time and memory O(n^2).
[[nodiscard]] Eigen::MatrixXd covariance(const FractionalNoise& noise, std::size_t n);

/// A predictor that weighs the calibration samples, whatever way the weights were found.
struct LinearPredictor {
  Eigen::MatrixXd weights;   ///< leads x calibration samples; row j predicts b + x at lead j + 1
  Eigen::VectorXd variance;  ///< stated error variance at each lead, v left out
};

/// The true variance, at each lead, of a'y - (b + x) for every row a of weights that sums to 1:
/// a'(C + r I) a - 2 a'c + c_0. Time O(leads samples^2).
[[nodiscard]] Eigen::VectorXd error_variance(const FractionalNoise& noise,
                                             const Eigen::MatrixXd& weights);

/// The covariance of the errors a'y - (b + x + v) of the raw samples at all leads, for rows of
/// weights that sum to 1: with A = (-weights, 1), A (C + r I) A'. Its sum is the variance of the
/// integrated error, its trace the mean of the squared RSSE. Time O(leads (samples + leads)^2).
[[nodiscard]] Eigen::MatrixXd error_covariance(const FractionalNoise& noise,
                                               const Eigen::MatrixXd& weights);

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

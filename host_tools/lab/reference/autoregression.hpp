/// @file
/// Autoregressive models fitted to the calibration data: what the paper names as competitors.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "host_tools/lab/reference/fractional_noise.hpp"

namespace zerorate::reference {

/// y_k - mean = sum_i coefficients_i (y_{k-i} - mean) + e_k, i from 1.
struct Autoregression {
  double mean = 0.0;
  Eigen::VectorXd coefficients;
  double innovation_variance = 0.0;  ///< variance of e
};

/// The mean of the data, and the coefficients by least squares of the one-step errors: what the
/// recursive least squares of Abeywardena and Munasinghe (2010), the paper's [21], arrive at. The
/// result need not be stationary. Throws std::invalid_argument unless values.size() > 2 order.
[[nodiscard]] Autoregression fit_least_squares(std::span<const double> values, std::size_t order);

/// The mean of the data, and the coefficients by Burg's recursion on the forward and backward
/// errors (Burg 1975; Kay 1988, section 7.5). Always stationary, which at
/// order 120, that of the paper's [22], least squares from 1000 samples are not. Time
/// O(values order). Throws std::invalid_argument unless values.size() > order.
[[nodiscard]] Autoregression fit_burg(std::span<const double> values, std::size_t order);

struct Forecast {
  Eigen::VectorXd values;
  Eigen::VectorXd variance;  ///< variance of y itself, under the model's parameters as if exact
};

/// The iterated forecast of the `leads` values after the data, and its variance
/// sigma^2 sum_{i<j} psi_i^2 with psi the model's impulse response. Time O(leads order).
/// @param values at least as many as the order
[[nodiscard]] Forecast forecast(const Autoregression& model, std::span<const double> values,
                                std::size_t leads);

/// The forecast as a weighing of the newest `order` values: row j holds the weights of
/// (y - mean), oldest first, in the forecast of lead j + 1. Time O(leads order^2).
[[nodiscard]] Eigen::MatrixXd forecast_weights(const Autoregression& model, std::size_t leads);

/// The weights to which the recursion of FullStateFilter comes, with the calibration mean as its
/// certain mean, found at once: neither the gains nor the covariances of a Kalman filter depend on
/// the data. With Psi = L(psi) split into the calibration's and the later rows,
///
///     C = s_f^2 Psi_1 Psi_1' + r I,   A = s_f^2 Psi_2 Psi_1' C^{-1},
///     predicted = ybar + A (y - ybar 1).
///
/// `variance` is what the filter states. It takes ybar as certain and is therefore too small; see
/// error_variance() for the truth. Time O(samples^2 (samples + leads)).
[[nodiscard]] LinearPredictor make_plug_in_predictor(const FractionalNoise& noise,
                                                     std::size_t samples, std::size_t leads);

}  // namespace zerorate::reference

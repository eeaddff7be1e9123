/// @file
/// The paper's Kalman filter as it is written there: one state a sample (eq. 5 and 6).
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "host_tools/lab/reference/fractional_noise.hpp"

namespace zerorate::reference {

/// The state is the mean and every value of x so far. It grows by one with each sample:
///
///     x_j = f_j' x_{1..j-1} + w_j,   [f_j]_i = -Gamma(j-i-d) / (Gamma(j-i+1) Gamma(-d)),
///     y_j = mean + x_j + v_j.
///
/// Time and memory of the n-th sample are O(n^2), of a calibration O(n^3). For the paper's filter
/// the mean is the mean of the calibration data, taken as certain (section IV-A).
class FullStateFilter {
 public:
  struct Mean {
    double value = 0.0;
    double variance = 0.0;  ///< 0: certain, as in the paper; a large number: nearly unknown
  };

  /// @param capacity how many samples the filter may see or predict at most
  FullStateFilter(const FractionalNoise& noise, const Mean& mean, std::size_t capacity);

  /// A filter which has already waited for `samples` without observing anything.
  static FullStateFilter after_waiting(const FractionalNoise& noise, std::size_t samples,
                                       std::size_t capacity);

  /// The next sample's state joins (eq. 5). Call it before each observation; without one, the
  /// filter predicts. Throws std::length_error beyond the capacity.
  void advance();
  /// The sample that advance() made room for.
  void observe(double value);

  /// mean + x at the newest sample, and the variance of its error.
  [[nodiscard]] double bias() const { return state_(0) + state_(size_ - 1); }
  [[nodiscard]] double bias_variance() const;
  /// Predicted variance of y at the newest sample, before it is observed.
  [[nodiscard]] double innovation_variance() const { return bias_variance() + white_variance_; }

 private:
  double driving_variance_;
  double white_variance_;
  Eigen::VectorXd lagged_;  ///< f of lag capacity, ..., 2, 1
  Eigen::VectorXd state_;   ///< mean, x_1, x_2, ...; the first size_ are in use
  Eigen::MatrixXd covariance_;
  Eigen::Index size_ = 1;
};

}  // namespace zerorate::reference

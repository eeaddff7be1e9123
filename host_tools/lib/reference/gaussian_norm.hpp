/// @file
/// How long a Gaussian vector is, without chance.
#pragma once

#include <Eigen/Core>

namespace zerorate::reference {

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

/// @file
/// The covariance of a sensor's bias written out tick by tick: the oracle of the closed forms.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <complex>

#include "core/noise/modes.hpp"

namespace zerorate::testing {

/// Covariance of the bias (without its unknown constant) at the ticks 1..n after the start.
/// Every mode's autocovariance is its variance at the earlier tick times Re F^lag.
template <std::size_t R, std::size_t C>
Eigen::MatrixXd bias_covariance(const core::Modes<R, C>& modes, int n) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  const auto add_mode = [&](std::complex<double> factor, double q, double initial_variance) {
    double variance = initial_variance;
    for (int k = 0; k < n; ++k) {
      variance = std::norm(factor) * variance + q;
      std::complex<double> power = 1.0;
      for (int l = k; l < n; ++l, power *= factor) {
        covariance(k, l) += variance * power.real();
        if (l != k) covariance(l, k) += variance * power.real();
      }
    }
  };
  for (const auto& mode : modes.decaying) {
    add_mode(1.0 - double{mode.one_minus_phi}, double{mode.noise_variance},
             double{mode.initial_variance});
  }
  for (const auto& mode : modes.rotating) {
    add_mode({1.0 - double{mode.one_minus_phi.re}, -double{mode.one_minus_phi.im}},
             double{mode.noise_variance}, double{mode.initial_variance});
  }
  add_mode(1.0, double{modes.walk_variance}, 0.0);
  return covariance;
}

}  // namespace zerorate::testing

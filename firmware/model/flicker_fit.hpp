/// @file
/// From flicker noise to the first-order lags that stand for it in the filter.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

/// A sum of independent first-order lags and white noise, sampled once a tick of the filter.
struct FlickerFit {
  std::vector<double> time_constants_s;   ///< shortest first, a factor of ten apart
  std::vector<double> variances_rad2_s2;  ///< stationary variance of each lag; 0 where not needed
  double white_variance_rad2_s2 =
      0.0;  ///< white noise that the lags leave at the highest frequencies
  /// Fitted over wanted spectrum, at its lowest and highest over the fitted band.
  double least_ratio = 0.0;
  double greatest_ratio = 0.0;

  /// Density per tick at a frequency in (0, 1/2] cycles per tick [rad2/s2 per (cycle/tick)].
  [[nodiscard]] double density(double tick_s, double cycles_per_tick) const;
};

/// Fits the lags to flicker noise sampled every `tick_s` seconds, whose spectrum per sample is
/// s_f^2 |2 sin(pi f)|^(-2d), s_f^2 = B^2 tick_s^(2d - 1) (paper, eq. 3; f in cycles per tick),
/// by non-negative least squares of the relative error on a logarithmic grid from the slowest lag's
/// corner, 1 / (2 pi tau_max), to f = 1/2.
///
/// The ripple is 0.94 to 1.06 for d = 1/2 as long as the quickest lag is about one tick or shorter.
/// With a much longer one the band between its corner and f = 1/2 has to be covered by that lag's
/// flank and white noise; the ratios are the errors.
///
/// Throws std::invalid_argument unless tick_s is positive and shorter than the slowest lag, and
/// `flicker` is valid (see validate()).
[[nodiscard]] FlickerFit fit_flicker(const Flicker& flicker, double tick_s);

/// The x >= 0 that minimises |rows x - wanted|, with columns of comparable length.
/// Active-set method (Lawson and Hanson 1974, chapter 23).
[[nodiscard]] Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& rows,
                                                        const Eigen::VectorXd& wanted);

}  // namespace zerorate::model

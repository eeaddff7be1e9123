/// @file
/// Noise strengths: what datasheets state (SI, independent of the sample rate) and what a sampled
/// model needs (per sample). All spectral densities are two-sided.
///
/// | noise   | density S(nu), (rad/s)^2/Hz     | per sample of period T |
/// |---------|---------------------------------|----------------------------------------------------|
/// | white   | N^2                             | variance r = N^2 / T | | flicker | B^2 / (2 pi
/// nu)^(2d)            | ARFIMA(0,d,0), innovation variance B^2 T^(2d - 1)  | | random walk | K^2 /
/// (2 pi nu)^2           | step variance K^2 T                                |
///
/// N: angle random walk in rad/s/sqrt(Hz) = rad/sqrt(s). B: the bias instability coefficient of
/// IEEE Std 952 (annex C) at d = 1/2, in rad/s; for other orders the density at 1 rad/s, hence in
/// rad/s * s^(1/2 - d). K: rate random walk in rad/s/sqrt(s).
#pragma once

#include <cmath>
#include <numbers>

namespace zerorate::spectrum {

/// Variance of a sample, rad^2/s^2, of white noise of the angle random walk.
[[nodiscard]] inline double white_variance(double angle_random_walk_rad_rt_s,
                                           double sample_period_s) {
  return angle_random_walk_rad_rt_s * angle_random_walk_rad_rt_s / sample_period_s;
}

/// The angle random walk, rad/sqrt(s), of white noise with the variance of a sample.
[[nodiscard]] inline double angle_random_walk(double variance_rad2_s2, double sample_period_s) {
  return std::sqrt(variance_rad2_s2 * sample_period_s);
}

/// Innovation variance, rad^2/s^2, of flicker noise of order d. At d = 1/2 it is B^2 at every
/// sample rate.
[[nodiscard]] inline double flicker_innovation_variance(double bias_instability_rad_s, double order,
                                                        double sample_period_s) {
  return bias_instability_rad_s * bias_instability_rad_s *
         std::pow(sample_period_s, 2.0 * order - 1.0);
}

/// The coefficient B of flicker noise with the innovation variance; inverse of the above.
[[nodiscard]] inline double bias_instability(double innovation_variance_rad2_s2, double order,
                                             double sample_period_s) {
  return std::sqrt(innovation_variance_rad2_s2 * std::pow(sample_period_s, 1.0 - 2.0 * order));
}

/// Two-sided density per sample, rad^2/s^2 per (cycle/sample), of ARFIMA(0,d,0) with unit
/// innovation variance at f in (0, 1/2] cycles per sample: |2 sin(pi f)|^(-2d).
[[nodiscard]] inline double fractional_density(double order, double cycles_per_sample) {
  return std::pow(2.0 * std::sin(std::numbers::pi * cycles_per_sample), -2.0 * order);
}

/// The floor of the Allan deviation of flicker noise of order 1/2, sqrt(2 ln 2 / pi) B = 0.664 B:
/// some datasheets state this figure as "bias instability".
[[nodiscard]] inline double allan_floor(double bias_instability_rad_s) {
  return std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi) * bias_instability_rad_s;
}

}  // namespace zerorate::spectrum

/// @file
/// Estimates of a rate's power spectral density, and the curves of a model that are drawn beside
/// them. The estimates are one-sided, in (unit of the rate)^2 / Hz:
/// the mean square is the integral over positive frequencies, and the figure is twice the two-sided
/// density of spectrum/noise_strength.hpp.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "firmware/model/sensor_model.hpp"

namespace zerorate::identify {

struct DensityPoint {
  double frequency_hz;
  double density;
};

/// Welch's estimate: segments overlapping by half, Hann window, averaged. The record's mean is
/// taken out, once; frequency 0 is left out. One segment's estimate has a relative standard error
/// of 1, s overlapping ones about sqrt(1.06 / s) (Welch 1967).
/// @param rate evenly spaced, at least one segment; throws std::invalid_argument otherwise
/// @param segment even, best without prime factors above 5 (spectrum::fast_length_below)
[[nodiscard]] std::vector<DensityPoint> welch_density(std::span<const double> rate,
                                                      double sample_period_s, std::size_t segment);

/// The periodogram at j / (n T), j = 1 .. n/2, of the first n = fast_length_below(size) samples,
/// mean taken out.
/// @param rate at least 2 samples; throws recording::DataError otherwise
[[nodiscard]] std::vector<DensityPoint> periodogram(std::span<const double> rate,
                                                    double sample_period_s);

struct DensityBin {
  double frequency_hz;  ///< mean of the points
  double density;       ///< mean of the points
  std::size_t points;   ///< relative standard error 1 / sqrt(points) for a periodogram
};

/// Means over bins of equal width on a logarithmic axis; empty bins are left out.
/// @param points in ascending, positive frequency
[[nodiscard]] std::vector<DensityBin> bin_logarithmically(std::span<const DensityPoint> points,
                                                          double bins_per_decade);

/// Two-sided density of a model's white and flicker noise, N^2 + B^2 (2 pi nu)^(-2d).
[[nodiscard]] double model_density(const model::SensorModel& model, double frequency_hz);

/// Allan deviation of a model's white noise and flicker decades, which the node stands for the
/// flicker noise with [rad/s]. Each decade of stationary variance q and time constant T adds, with
/// a = tau / T (IEEE Std 952, annex C: exponentially correlated noise),
///
///     sigma^2(tau) = 2 q / a (1 - (3 - 4 e^(-a) + e^(-2a)) / (2a)).
///
/// Other parts of the model are left out.
[[nodiscard]] double model_allan_deviation(const model::SensorModel& model, double tau_s);

/// Where the densities of white and flicker noise are equal [Hz]: averages much longer than its
/// inverse are dominated by flicker noise. The model has flicker noise.
[[nodiscard]] double corner_frequency_hz(const model::SensorModel& model);

}  // namespace zerorate::identify

/// @file
/// Estimates of a rate's power spectral density. All are one-sided, in (unit of the rate)^2 / Hz:
/// the mean square is the integral over positive frequencies, and the figure is twice the two-sided
/// density of spectrum/noise_strength.hpp.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

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

}  // namespace zerorate::identify

/// @file
/// Tail probabilities and their logarithms, and how surprising a gain of log likelihood is.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

namespace zerorate::statistics {

/// Half the width of the customary 95 % interval, in standard deviations.
inline constexpr double kHalfWidth95 = 1.96;
/// Half the 95 % quantile of chi squared with one degree of freedom: how far the profile likelihood
/// falls to the ends of a 95 % interval [nats].
inline constexpr double kHalfChiSquared95 = 1.92;

/// log P of a standard normal beyond |z|, both sides.
[[nodiscard]] double log_normal_tails(double z);
/// log P of chi squared above x.
[[nodiscard]] double log_chi_squared_tail(double x, double freedom);
/// log P of chi squared below x.
[[nodiscard]] double log_chi_squared_lower_tail(double x, double freedom);
/// log P of chi squared as far from its middle as x, both sides.
[[nodiscard]] double log_chi_squared_tails(double x, double freedom);
/// log P of a Poisson number of at least `count`.
[[nodiscard]] double log_poisson_tail(double count, double mean);
/// The smallest of `places` such probabilities, at least.
[[nodiscard]] double log_of_smallest(double log_p, double places);
/// Chi squared made standard normal (Wilson and Hilferty 1931).
[[nodiscard]] double normal_of_chi_squared(double x, double freedom);

/// A gain by `parameters` free amplitudes, 2 G ~ chi squared (Wilks).
[[nodiscard]] double surprisal_of_free(double gain_nats, double parameters);

/// A gain by one strength that cannot be negative: half of the time 0 (Self and Liang 1987).
[[nodiscard]] double surprisal_of_strength(double gain_nats);

/// The greatest gain over a searched parameter, which crosses a level upwards `crossings` e^(-G)
/// times on average (Davies 1987), beside the probability at a single place.
/// @param parameters of the amplitudes, 1 or 2
[[nodiscard]] double surprisal_of_search(double gain_nats, double parameters, double crossings);

/// Probability of a standard normal above z.
[[nodiscard]] inline double normal_tail(double z) {
  return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

/// Density of a standard normal at z.
[[nodiscard]] inline double normal_density(double z) {
  return std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
}

}  // namespace zerorate::statistics

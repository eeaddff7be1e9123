/// @file
/// Logarithms of tail probabilities.
#pragma once

#include <cstddef>

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

}  // namespace zerorate::statistics

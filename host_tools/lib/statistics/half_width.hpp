/// @file
/// Half the width of the customary 95 % interval.
#pragma once

namespace zerorate::statistics {

/// Standard deviations of a normal distribution.
inline constexpr double kHalfWidth95 = 1.959963984540054;
/// Fall of the profile likelihood to the ends of the interval [nats]: half the 95 % quantile of chi
/// squared with one degree of freedom.
inline constexpr double kHalfChiSquared95 = 0.5 * kHalfWidth95 * kHalfWidth95;

}  // namespace zerorate::statistics

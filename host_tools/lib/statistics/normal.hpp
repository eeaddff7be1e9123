/// @file
/// Constants of the normal distribution.
#pragma once

namespace zerorate::statistics {

/// Half the width of the customary 95 % interval, in standard deviations.
inline constexpr double kHalfWidth95 = 1.96;
/// Half the 95 % quantile of chi squared with one degree of freedom: how far the profile likelihood
/// falls to the ends of a 95 % interval [nats].
inline constexpr double kHalfChiSquared95 = 1.92;

}  // namespace zerorate::statistics

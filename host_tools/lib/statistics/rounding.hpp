/// @file
/// Shift of the mean of noisy values by rounding to levels.
#pragma once

namespace zerorate::statistics {

/// The mean before rounding to whole numbers, of a standard deviation of `sigma` steps, that makes
/// `mean` the mean after it: rounding adds sum over k of (-1)^k / (pi k) exp(-2 (pi k sigma)^2)
/// sin(2 pi k x) to a mean x (Widrow and Kollar 2008).
[[nodiscard]] double mean_before_rounding(double mean, double sigma);

}  // namespace zerorate::statistics

/// @file
/// White and flicker noise of a recording by the Whittle likelihood: quick, and the start of the
/// exact likelihood through the node's filter.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "host_tools/lib/identify/allan_deviation.hpp"

namespace zerorate::identify {

struct FlickerEstimate {
  Estimate innovation_variance;  ///< s_f^2, (unit of the rate)^2; see spectrum/noise_strength.hpp
  Estimate order;                ///< d; standard error 0 where it was given
};

struct WhiteFlickerFit {
  Estimate white_variance;  ///< r, (unit of the rate)^2 a sample
  /// Nothing when the recording does not show flicker noise at the asked significance; the white
  /// variance is that of white noise alone then.
  std::optional<FlickerEstimate> flicker;
  double likelihood_ratio;  ///< 2 log of likelihood with over without flicker noise
  double p_value;           ///< probability of a ratio this large under white noise alone
};

struct WhiteFlickerOptions {
  std::optional<double>
      order{};  ///< d in (0, 1) where it is known; estimated in [0.05, 1] otherwise
  double significance = 0.01;
};

/// Fits S(f) = r + s_f^2 |2 sin(pi f)|^(-2d) to the orthonormal DCT-II coefficients c_k, k >= 1, of
/// the record: -2 log L = sum log S_k + c_k^2 / S_k, f = k / (2n). The mean is free: c_0 is left
/// out. The DCT is exact for white noise and a random walk and leaks little in between, see
/// dct_power_ratios. Coefficients are gathered in narrow bins, so that the time is that of the
/// transform, O(n log n), and some 10 ms.
/// The standard errors are those of the expected information. The p-value takes the ratio as chi
/// squared with two degrees of freedom when d is free, and as half of chi squared with one when it
/// is given, since the strength 0 lies at the edge of its range.
/// @param rate evenly spaced, at least 64 samples, not constant; throws recording::DataError
///        otherwise. All but the last few are used (spectrum::fast_length_below).
[[nodiscard]] WhiteFlickerFit fit_white_flicker(std::span<const double> rate,
                                                const WhiteFlickerOptions& options = {});

/// Coefficients of a DCT that have a ratio of their own; those above are nearly at 1.
inline constexpr std::size_t kDctRatios = 32;

/// Ratios of the variance of DCT coefficient k of a long record of noise of order d to its nominal
/// value S(k / (2n)), for k = 1 .. 32: 1 for d = 0 and d = 1, about 1 - 0.2 / k at d = 1/2.
/// From the covariance K(u) of |omega|^(-2d), in units of the record's length:
/// (pi k)^(2d) 2 int_0^1 K(u) [(1 - u) cos(pi k u) - sin(pi k u) / (pi k)] du.
/// Some 30 us.
/// @param order in [0, 1]
[[nodiscard]] std::array<double, kDctRatios> dct_power_ratios(double order);

/// A common choice of how many frequencies to use, n^0.65: more lower the standard error, but take
/// in frequencies where white noise flattens the spectrum and biases the order downwards. Stay
/// below f_c n, with f_c the corner between white and flicker noise in cycles per sample.
[[nodiscard]] std::size_t local_whittle_bandwidth(std::size_t samples);

/// Minimises R(d) = log G(d) - 2 d mean(log |1 - e^{-i lambda_j}|), G(d) the mean of the
/// periodogram of (1-L)^d (x - mean) at lambda_j = 2 pi j / n, j = 1 .. m, over d in [-1/2, 1]
/// (Shimotsu and Phillips 2005, eq. 3, with the gain of 1 - L in place of its limit lambda_j, which
/// spares ARFIMA noise the bias of higher frequencies). With the sample mean for the unknown one
/// the estimate is consistent below d = 1 and normal below 3/4 (Shimotsu 2010, section 3); a result
/// at an end of the range means that d is beyond. The standard error is 1 / (2 sqrt(sum (log gain -
/// mean)^2)), which tends to 1 / (2 sqrt(m)) but is closer to the truth at small m. Time about 15
/// fractional differences; long records are better averaged in blocks first, which leaves the low
/// frequencies as they are.
/// @param values evenly spaced; all but the last few are used (spectrum::fast_length_below)
/// @param frequencies m in [2, n/2); throws std::invalid_argument otherwise, and for
///        records that are constant or not finite
[[nodiscard]] Estimate exact_local_whittle(std::span<const double> values, std::size_t frequencies);

}  // namespace zerorate::identify

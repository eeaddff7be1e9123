/// @file
/// The order of 1/f noise without a model of anything else: the exact local Whittle estimate.
#pragma once

#include <cstddef>
#include <span>

#include "host_tools/lib/identify/allan_deviation.hpp"

namespace zerorate::identify {

/// A common choice of how many frequencies to use, n^0.65: more lower the standard error, but take
/// in frequencies where white noise flattens the spectrum and biases the order downwards. Stay
/// below f_c n, with f_c the corner between white and flicker noise in cycles per sample.
[[nodiscard]] std::size_t local_whittle_bandwidth(std::size_t samples);

/// Minimises R(d) = log G(d) - 2 d mean(log |1 - e^{-i lambda_j}|), G(d) the mean of the
/// periodogram of (1-L)^d (x - mean) at lambda_j = 2 pi j / n, j = 1 .. m, over d in [-1/2, 1]
/// (Shimotsu and Phillips 2005, eq. 3, with the gain of 1 - L in place of its limit lambda_j, which
/// spares ARFIMA noise the bias of higher frequencies). With the sample mean for the unknown one
/// the estimate is consistent below d = 1 and normal below 3/4 (Shimotsu 2010, section 3); a result
/// at an end of the range says that d is beyond. The standard error is 1 / (2 sqrt(sum (log gain -
/// mean)^2)), which tends to 1 / (2 sqrt(m)) but is closer to the truth at small m. Time about 15
/// fractional differences; long records are better averaged in blocks first, which leaves the low
/// frequencies as they are.
/// @param values evenly spaced; all but the last few are used (spectrum::fast_length_below)
/// @param frequencies m in [2, n/2); throws std::invalid_argument otherwise, and for
///        records that are constant or not finite
[[nodiscard]] Estimate exact_local_whittle(std::span<const double> values, std::size_t frequencies);

}  // namespace zerorate::identify

/// @file
/// The discrete cosine transform of type II, the whitening basis of records with a drift.
#pragma once

#include <span>
#include <vector>

namespace zerorate::spectrum {

/// The orthonormal DCT-II: c_0 = sum x / sqrt(n), and for k = 1 .. n-1
/// c_k = sqrt(2/n) sum_i x_i cos(pi k (2 i + 1) / (2 n)), of frequency k/(2n) cycles per sample.
/// By one real transform of the same length (Makhoul 1980), O(n log n).
/// @param values n numbers, n as RealFft wants it
[[nodiscard]] std::vector<double> cosine_transform(std::span<const double> values);

}  // namespace zerorate::spectrum

/// @file
/// The discrete cosine transform of type II, the whitening basis of records with a drift.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "host_tools/lib/spectrum/real_fft.hpp"

namespace zerorate::spectrum {

/// The orthonormal DCT-II and its inverse at one length, with their tables:
/// c_0 = sum x / sqrt(n), and for k = 1 .. n-1
/// c_k = sqrt(2/n) sum_i x_i cos(pi k (2 i + 1) / (2 n)), of frequency k/(2n) cycles per sample.
/// By one real transform of the same length (Makhoul 1980), O(n log n).
class CosineTransform {
 public:
  /// @param length n as RealFft wants it
  explicit CosineTransform(std::size_t length);

  [[nodiscard]] std::size_t length() const { return fft_.length(); }
  /// The Fourier transform of the same length, with its tables.
  [[nodiscard]] const RealFft& fourier() const { return fft_; }
  /// @param values n numbers
  [[nodiscard]] std::vector<double> forward(std::span<const double> values) const;
  /// @param coefficients n numbers
  [[nodiscard]] std::vector<double> inverse(std::span<const double> coefficients) const;

 private:
  RealFft fft_;
  std::vector<std::complex<double>> turns_;  ///< exp(i pi k / 2n), k = 0 .. n/2
};

/// CosineTransform::forward of a single record.
[[nodiscard]] std::vector<double> cosine_transform(std::span<const double> values);

}  // namespace zerorate::spectrum

/// @file
/// Discrete Fourier and cosine transforms of double-precision sequences (kissfft's template
/// underneath).
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace zerorate::spectrum {

/// The largest even number 2^a 3^b 5^c that is not above n; the transform is fast at such lengths.
/// @param n at least 2
[[nodiscard]] std::size_t fast_length_below(std::size_t n);

/// Forward and inverse transform of one length, with its tables. A const object may be shared by
/// threads as long as each brings its own data, provided that the length has no prime factor
/// above 5.
class RealFft {
 public:
  /// @param length n of the real sequence, even and at least 2, which is
  ///        asserted.
  ///        Time O(n sum of prime factors): see fast_length_below.
  explicit RealFft(std::size_t length);
  ~RealFft();
  RealFft(RealFft&&) noexcept;
  RealFft& operator=(RealFft&&) noexcept;

  [[nodiscard]] std::size_t length() const { return length_; }
  /// Number of complex bins, n/2 + 1: frequencies 0, 1/n, ..., 1/2 cycles per sample.
  [[nodiscard]] std::size_t bins() const { return length_ / 2 + 1; }

  /// bins[j] = sum_k values[k] exp(-2 pi i j k / n).
  /// @param values n real numbers  @param bins n/2 + 1 complex numbers
  void forward(std::span<const double> values, std::span<std::complex<double>> bins) const;

  /// Undoes forward, the factor 1/n included. The imaginary parts of the first and the last bin are
  /// taken as zero.
  void inverse(std::span<const std::complex<double>> bins, std::span<double> values) const;

 private:
  struct Tables;
  std::size_t length_;
  std::unique_ptr<Tables> tables_;
};

/// Transform of complex sequences of one length, with its tables, as RealFft is one of real ones.
class ComplexFft {
 public:
  explicit ComplexFft(std::size_t length);
  ~ComplexFft();
  ComplexFft(ComplexFft&&) noexcept;
  ComplexFft& operator=(ComplexFft&&) noexcept;

  /// bins[j] = sum_k values[k] exp(-2 pi i j k / n).
  /// @param values, bins n complex numbers each, that do not overlap
  void forward(std::span<const std::complex<double>> values,
               std::span<std::complex<double>> bins) const;

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

/// Product without the rules for NaN and infinity of std::complex's operator*, which take a call.
[[nodiscard]] inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

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

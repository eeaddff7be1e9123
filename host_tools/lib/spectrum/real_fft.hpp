/// @file
/// Discrete Fourier transform of real, double-precision sequences (kissfft's template underneath).
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>

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

/// Product without the rules for NaN and infinity of std::complex's operator*, which take a call.
[[nodiscard]] inline std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace zerorate::spectrum

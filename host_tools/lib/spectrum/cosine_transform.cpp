#include "host_tools/lib/spectrum/cosine_transform.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include "host_tools/lib/spectrum/real_fft.hpp"

namespace zerorate::spectrum {

std::vector<double> cosine_transform(std::span<const double> values) {
  const std::size_t n = values.size();
  const RealFft fft(n);
  std::vector<double> folded(n);  // the even samples forwards, then the odd ones backwards
  for (std::size_t i = 0; i < n / 2; ++i) {
    folded[i] = values[2 * i];
    folded[n - 1 - i] = values[2 * i + 1];
  }
  std::vector<std::complex<double>> bins(fft.bins());
  fft.forward(folded, bins);

  std::vector<double> coefficients(n);
  const double scale = std::sqrt(2.0 / static_cast<double>(n));
  coefficients[0] = bins[0].real() / std::sqrt(static_cast<double>(n));
  for (std::size_t k = 1; k <= n / 2; ++k) {
    const double turn = std::numbers::pi * static_cast<double>(k) / static_cast<double>(2 * n);
    const std::complex<double> rotated = bins[k] * std::polar(scale, -turn);
    coefficients[k] = rotated.real();
    coefficients[n - k] = -rotated.imag();
  }
  return coefficients;
}

}  // namespace zerorate::spectrum

#include "host_tools/lib/spectrum/cosine_transform.hpp"

#include <cmath>
#include <numbers>

#include "core/base/assert.hpp"
#include "host_tools/lib/spectrum/real_fft.hpp"

namespace zerorate::spectrum {
namespace {

using Complex = std::complex<double>;

}  // namespace

CosineTransform::CosineTransform(std::size_t length) : fft_(length), turns_(length / 2 + 1) {
  const double step = std::numbers::pi / static_cast<double>(2 * length);
  for (std::size_t k = 0; k < turns_.size(); ++k) {
    turns_[k] = std::polar(1.0, step * static_cast<double>(k));
  }
}

std::vector<double> CosineTransform::forward(std::span<const double> values) const {
  const std::size_t n = length();
  ZERORATE_ASSERT(values.size() == n);
  std::vector<double> folded(n);  // the even samples forwards, then the odd ones backwards
  for (std::size_t i = 0; i < n / 2; ++i) {
    folded[i] = values[2 * i];
    folded[n - 1 - i] = values[2 * i + 1];
  }
  std::vector<Complex> bins(fft_.bins());
  fft_.forward(folded, bins);

  std::vector<double> coefficients(n);
  const double scale = std::sqrt(2.0 / static_cast<double>(n));
  coefficients[0] = bins[0].real() / std::sqrt(static_cast<double>(n));
  for (std::size_t k = 1; k <= n / 2; ++k) {
    const Complex rotated = scale * product(bins[k], std::conj(turns_[k]));
    coefficients[k] = rotated.real();
    coefficients[n - k] = -rotated.imag();
  }
  return coefficients;
}

std::vector<double> CosineTransform::inverse(std::span<const double> coefficients) const {
  const std::size_t n = length();
  ZERORATE_ASSERT(coefficients.size() == n);
  const double scale = std::sqrt(static_cast<double>(n) / 2.0);
  std::vector<Complex> bins(fft_.bins());
  bins[0] = coefficients[0] * std::sqrt(static_cast<double>(n));
  for (std::size_t k = 1; k <= n / 2; ++k) {
    const Complex rotated{coefficients[k], -coefficients[n - k]};
    bins[k] = scale * product(rotated, turns_[k]);
  }
  std::vector<double> folded(n);
  fft_.inverse(bins, folded);
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n / 2; ++i) {
    values[2 * i] = folded[i];
    values[2 * i + 1] = folded[n - 1 - i];
  }
  return values;
}

std::vector<double> cosine_transform(std::span<const double> values) {
  return CosineTransform(values.size()).forward(values);
}

}  // namespace zerorate::spectrum

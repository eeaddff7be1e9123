#include <cmath>
#include <kissfft/kissfft.hh>
#include <numbers>
#include <vector>

#include "core/base/assert.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::spectrum {
namespace {

using Complex = std::complex<double>;

// The real sequence read as n/2 complex numbers; std::complex guarantees the layout.
Complex* as_pairs(double* values) {
  return reinterpret_cast<Complex*>(values);
}

bool has_only_small_factors(std::size_t n) {
  for (const std::size_t factor : {2U, 3U, 5U}) {
    while (n % factor == 0) n /= factor;
  }
  return n == 1;
}

}  // namespace

std::size_t fast_length_below(std::size_t n) {
  std::size_t length = n - n % 2;
  while (length > 2 && !has_only_small_factors(length)) length -= 2;
  return length;
}

struct RealFft::Tables {
  explicit Tables(std::size_t half) : forward(half, false), inverse(half, true), twiddles(half) {
    const double step = std::numbers::pi / static_cast<double>(half);
    for (std::size_t k = 0; k < half; ++k) {
      twiddles[k] = std::polar(1.0, step * static_cast<double>(k));
    }
  }
  kissfft<double> forward;
  kissfft<double> inverse;
  std::vector<Complex> twiddles;  // exp(+2 pi i k / n)
};

RealFft::RealFft(std::size_t length) : length_(length) {
  ZERORATE_ASSERT(length >= 2 && length % 2 == 0);
  tables_ = std::make_unique<Tables>(length / 2);
}
RealFft::~RealFft() = default;
RealFft::RealFft(RealFft&&) noexcept = default;
RealFft& RealFft::operator=(RealFft&&) noexcept = default;

void RealFft::forward(std::span<const double> values, std::span<Complex> bins) const {
  ZERORATE_ASSERT(values.size() == length_ && bins.size() == this->bins());
  tables_->forward.transform_real(values.data(), bins.data());
  bins.back() = bins.front().imag();  // kissfft packs the two real bins into the first
  bins.front() = bins.front().real();
}

void RealFft::inverse(std::span<const Complex> bins, std::span<double> values) const {
  ZERORATE_ASSERT(values.size() == length_ && bins.size() == this->bins());
  const std::size_t half = length_ / 2;
  const double scale = 1.0 / static_cast<double>(length_);
  std::vector<Complex> pairs(half);
  pairs[0] = {scale * (bins.front().real() + bins.back().real()),
              scale * (bins.front().real() - bins.back().real())};
  for (std::size_t k = 1; k < half; ++k) {
    // Spectra of the even and of the odd samples, even + i odd is the spectrum of the pairs.
    const Complex even = bins[k] + std::conj(bins[half - k]);
    const Complex odd = product(bins[k] - std::conj(bins[half - k]), tables_->twiddles[k]);
    pairs[k] = {scale * (even.real() - odd.imag()), scale * (even.imag() + odd.real())};
  }
  tables_->inverse.transform(pairs.data(), as_pairs(values.data()));
}

struct ComplexFft::Tables {
  explicit Tables(std::size_t of) : length(of), forward(of, false) {}
  std::size_t length;
  kissfft<double> forward;
};

ComplexFft::ComplexFft(std::size_t length) : tables_(std::make_unique<Tables>(length)) {}
ComplexFft::~ComplexFft() = default;
ComplexFft::ComplexFft(ComplexFft&&) noexcept = default;
ComplexFft& ComplexFft::operator=(ComplexFft&&) noexcept = default;

void ComplexFft::forward(std::span<const Complex> values, std::span<Complex> bins) const {
  ZERORATE_ASSERT(values.size() == tables_->length && bins.size() == tables_->length);
  tables_->forward.transform(values.data(), bins.data());
}

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

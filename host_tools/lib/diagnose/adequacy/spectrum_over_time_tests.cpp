#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>

#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"
#include "host_tools/lib/diagnose/adequacy/tails.hpp"
#include "host_tools/lib/spectrum/real_fft.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kMostBins = 2500;

/// Power of each frequency in each stretch of time, of mean 1.
struct Spectrogram {
  std::size_t stretches;
  std::size_t bins;
  std::vector<double> power;  ///< stretch after stretch

  [[nodiscard]] double at(std::size_t stretch, std::size_t bin) const {
    return power[stretch * bins + bin];
  }
};

Spectrogram spectrogram_of(const std::vector<double>& values, std::size_t stretches) {
  const std::size_t length = spectrum::fast_length_below(values.size() / stretches);
  const spectrum::RealFft fft(length);
  Spectrogram result{stretches, length / 2 - 1, {}};
  result.power.reserve(stretches * result.bins);
  std::vector<std::complex<double>> bins(fft.bins());
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t first = s * (values.size() / stretches);
    fft.forward(std::span(values).subspan(first, length), bins);
    for (std::size_t j = 1; j <= result.bins; ++j) {
      result.power.push_back(std::norm(bins[j]) / static_cast<double>(length));
    }
  }
  return result;
}

/// Sums over patches of the spectrogram.
void test_patches(const Remainder& remainder, std::size_t stretches, std::size_t bands,
                  Tests& tests) {
  const Spectrogram spectrogram = spectrogram_of(remainder.values, stretches);
  const std::size_t width = spectrogram.bins / bands;
  if (width < 4) return;
  double sum = 0.0;
  double most = 0.0;
  std::size_t at = 0;
  for (std::size_t s = 0; s < stretches; ++s) {
    for (std::size_t b = 0; b < bands; ++b) {
      double power = 0.0;
      for (std::size_t j = b * width; j < (b + 1) * width; ++j) power += spectrogram.at(s, j);
      const double z = normal_of_chi_squared(2.0 * power, 2.0 * static_cast<double>(width));
      sum += z * z;
      if (std::abs(z) <= most) continue;
      most = std::abs(z);
      at = s;
    }
  }
  const auto patches = static_cast<double>(stretches * bands);
  const Problem& problem = remainder.explanation->problem();
  tests.push_back({"the spectrum changes over time", log_chi_squared_tail(sum, patches)});
  tests.push_back(
      {fmt::format("the spectrum is another near {:.4g} s",
                   problem.series().time_s((2 * at + 1) * problem.size() / (2 * stretches))),
       log_of_smallest(log_normal_tails(most), patches)});
}

/// The straight line through the spectrogram that holds the most power.
Test moving_tone(const Remainder& remainder, std::size_t stretches) {
  const Spectrogram spectrogram = spectrogram_of(remainder.values, stretches);
  const std::size_t bins = spectrogram.bins;
  const std::size_t last = stretches - 1;
  double most = 0.0;
  double lines = 0.0;
  // Neighbouring lines share most of their bins; every other end is enough where there are many.
  const std::size_t stride = bins > 600 ? 2 : 1;
  const std::size_t reach = std::min(bins, kMostBins / 4 * stride);
  for (std::size_t from = 0; from < bins; ++from) {
    const std::size_t least = from > reach ? from - reach : 0;
    const std::size_t end = std::min(bins, from + reach);
    for (std::size_t to = least; to < end; to += stride) {
      double power = 0.0;
      const double slope =
          (static_cast<double>(to) - static_cast<double>(from)) / static_cast<double>(last);
      double place = static_cast<double>(from) + 0.5;
      for (std::size_t s = 0; s < stretches; ++s) {
        power += spectrogram.power[s * bins + static_cast<std::size_t>(place)];
        place += slope;
      }
      most = std::max(most, power);
      lines += 1.0;
    }
  }
  return {"a tone moves through the spectrum",
          log_of_smallest(log_chi_squared_tail(2.0 * most, 2.0 * static_cast<double>(stretches)),
                          lines)};
}

}  // namespace

Tests test_spectrum_over_time(const Remainder& remainder) {
  Tests tests;
  test_patches(remainder, 8, 8, tests);
  test_patches(remainder, 32, 16, tests);
  for (const std::size_t stretches : {4U, 8U, 16U, 32U, 64U}) {
    if (remainder.values.size() / stretches < 32) break;
    if (remainder.values.size() / stretches > 2 * kMostBins) continue;
    tests.push_back(moving_tone(remainder, stretches));
  }
  return tests;
}

}  // namespace zerorate::diagnose

#include "host_tools/lib/diagnose/hypothesis/spectrum_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kSize = 20'000;

/// Coefficients whose squares are just what a spectrum lets expect, computed without the class's
/// own density: at the maximum of the likelihood stands the spectrum itself.
std::vector<SpectralBin> expected_bins(const NoiseSpectrum& spectrum) {
  std::vector<double> coefficients(kSize);
  for (std::size_t k = 1; k < kSize; ++k) {
    const double w = std::numbers::pi * static_cast<double>(k) / static_cast<double>(kSize);
    const double square = 2.0 - 2.0 * std::cos(w);
    const double phi = std::exp(-1.0 / spectrum.markov_samples);
    const double a = spectrum.low_pass_share;
    const double inner =
        spectrum.white_variance +
        spectrum.flicker_variance * std::pow(square, -spectrum.flicker_order) +
        spectrum.walk_variance / square +
        spectrum.markov_variance * (1.0 - phi * phi) / (1.0 + phi * phi - 2.0 * phi * std::cos(w));
    const double pass = a * a / (1.0 + (1.0 - a) * (1.0 - a) - 2.0 * (1.0 - a) * std::cos(w));
    coefficients[k] = std::sqrt(inner * pass);
  }
  return bin_coefficients(coefficients);
}

SpectrumFit fit(const NoiseSpectrum& truth, const NoiseTerms& terms, NoiseSpectrum start) {
  const auto bins = expected_bins(truth);
  return fit_spectrum(bins, kSize, terms, std::vector{start});
}

TEST(SpectrumOfWhiteAndFlickerNoise, IsFittedFromARoughStart) {
  const NoiseSpectrum truth{.white_variance = 2.0, .flicker_variance = 0.05};
  const SpectrumFit result = fit(truth, {}, rough_spectrum(expected_bins(truth)));
  // The lowest coefficients of flicker noise are some percent below nominal, which these are not.
  EXPECT_NEAR(result.spectrum.white_variance, 2.0, 0.002);
  EXPECT_NEAR(result.spectrum.flicker_variance, 0.05, 0.001);
  // Half the information of n white coefficients at least.
  EXPECT_NEAR(result.error(NoiseParameterId::white_variance), std::sqrt(2.0 / kSize),
              0.6 * std::sqrt(2.0 / kSize));
}

TEST(SpectrumWithARandomWalk, IsFitted) {
  const NoiseSpectrum truth{.white_variance = 1.0, .flicker_variance = 0.01, .walk_variance = 1e-4};
  NoiseSpectrum start = truth;
  start.walk_variance = 1e-6;
  start.flicker_variance = 0.05;
  const SpectrumFit result = fit(truth, {.random_walk = true}, start);
  EXPECT_NEAR(result.spectrum.walk_variance, 1e-4, 2e-6);
}

TEST(SpectrumOfAnotherOrder, IsFitted) {
  const NoiseSpectrum truth{.white_variance = 1.0, .flicker_variance = 0.05, .flicker_order = 0.7};
  const SpectrumFit result =
      fit(truth, {.free_order = true}, {.white_variance = 1.0, .flicker_variance = 0.1});
  EXPECT_NEAR(result.spectrum.flicker_order, 0.7, 0.01);
}

TEST(SpectrumWithGaussMarkovNoise, IsFittedWithItsTimeConstant) {
  const NoiseSpectrum truth{.white_variance = 1.0,
                            .flicker_variance = 0.01,
                            .markov_variance = 0.5,
                            .markov_samples = 40.0};
  NoiseSpectrum start = truth;
  start.markov_variance = 0.1;
  start.markov_samples = 12.0;
  const SpectrumFit result = fit(truth, {.gauss_markov = true}, start);
  EXPECT_NEAR(result.spectrum.markov_variance, 0.5, 0.01);
  EXPECT_NEAR(result.spectrum.markov_samples, 40.0, 1.0);
}

/// Variance times the transform of phi^|k| cos(w0 k), as a sum over k.
double line_power(double variance, double angle, double samples, double w) {
  double sum = 1.0;
  for (int k = 1; k < 40.0 * samples; ++k) {
    sum += 2.0 * std::exp(-k / samples) * std::cos(angle * k) * std::cos(w * k);
  }
  return variance * sum;
}

TEST(SpectrumWithALineOfFiniteWidth, IsFittedFromABroaderOne) {
  constexpr double kAngle = 0.35;
  constexpr double kCoherence = 150.0;
  constexpr double kVariance = 0.02;
  std::vector<double> coefficients(kSize);
  for (std::size_t k = 1; k < kSize; ++k) {
    const double w = std::numbers::pi * static_cast<double>(k) / static_cast<double>(kSize);
    coefficients[k] = std::sqrt(1.0 + 0.01 / (2.0 * std::sin(0.5 * w)) +
                                line_power(kVariance, kAngle, kCoherence, w));
  }
  const NoiseSpectrum start{.white_variance = 1.0,
                            .flicker_variance = 0.02,
                            .line_variance = 0.05,
                            .line_angle = kAngle + 2.0 / kCoherence,
                            .line_samples = 0.3 * kCoherence};
  const auto line = static_cast<std::size_t>(start.line_angle / std::numbers::pi * kSize);
  const SpectrumFit result =
      fit_spectrum(bin_coefficients(coefficients, line), kSize, {.line = true}, std::vector{start});
  EXPECT_NEAR(result.spectrum.line_angle, kAngle, 0.02 / kCoherence);
  EXPECT_NEAR(result.spectrum.line_samples, kCoherence, 0.02 * kCoherence);
  EXPECT_NEAR(result.spectrum.line_variance, kVariance, 0.02 * kVariance);
  EXPECT_NEAR(result.spectrum.white_variance, 1.0, 0.002);
  // The maximum has no slope: the derivatives are those of the density.
  const SpectrumFit again = fit_spectrum(bin_coefficients(coefficients, line), kSize,
                                         {.line = true}, std::vector{result.spectrum});
  EXPECT_NEAR(again.log_likelihood, result.log_likelihood, 1e-3);
}

TEST(LineOfFiniteWidth, HasItsVarianceInAllBandsTogether) {
  const NoiseSpectrum line{.line_variance = 0.3, .line_angle = 2.9, .line_samples = 7.0};
  constexpr int kBands = 64;
  double sum = 0.0;
  for (int i = 0; i < kBands; ++i) {
    sum += line.line_density(std::numbers::pi * (i + 0.5) / kBands, std::numbers::pi / kBands);
  }
  EXPECT_NEAR(sum / kBands, 0.3, 1e-9);
}

TEST(SpectrumBehindALowPass, IsFittedWithItsShare) {
  const NoiseSpectrum truth{.white_variance = 1.0, .flicker_variance = 0.01, .low_pass_share = 0.4};
  NoiseSpectrum start = truth;
  start.low_pass_share = 0.9;
  const SpectrumFit result = fit(truth, {.low_pass = true}, start);
  EXPECT_NEAR(result.spectrum.low_pass_share, 0.4, 0.001);
}

// Gain by the bilinear transform with cos and sin, not with the tangent.
double butterworth_gain(double w, double cut_off, int order) {
  const double kept = std::pow(std::sin(0.5 * cut_off) * std::cos(0.5 * w), 2 * order);
  const double lost = std::pow(std::cos(0.5 * cut_off) * std::sin(0.5 * w), 2 * order);
  return kept / (kept + lost);
}

TEST(SpectrumBehindAButterworthFilter, IsFittedWithItsCutOff) {
  constexpr double kRounding = 1e-3;
  std::vector<double> coefficients(kSize);
  for (std::size_t k = 1; k < kSize; ++k) {
    const double w = std::numbers::pi * static_cast<double>(k) / static_cast<double>(kSize);
    const double pass = butterworth_gain(w, 0.7 * std::numbers::pi, 2);
    coefficients[k] = std::sqrt(pass * (1.0 + 0.01 / (2.0 * std::sin(0.5 * w))) + kRounding);
  }
  NoiseSpectrum start{.white_variance = 0.5,
                      .flicker_variance = 0.02,
                      .low_pass_share = 0.5,
                      .rounding_variance = kRounding};
  const NoiseSpectrum recursive = start;
  start.filter_order = 2;
  const SpectrumFit result = fit_spectrum(bin_coefficients(coefficients), kSize, {.low_pass = true},
                                          std::vector{recursive, start});
  EXPECT_EQ(result.spectrum.filter_order, 2);
  EXPECT_NEAR(result.spectrum.low_pass_share, 0.7, 0.001);
  EXPECT_NEAR(result.spectrum.white_variance, 1.0, 0.002);
}

TEST(SpectrumOfSingleValues, HasTheDensityOfTheirMeans) {
  constexpr std::size_t kMeans = 1'000'000;
  constexpr double kCount = 50.0;
  const NoiseSpectrum means{.white_variance = 0.3,
                            .flicker_variance = 0.02,
                            .flicker_order = 0.7,
                            .walk_variance = 1e-6,
                            .markov_variance = 0.01,
                            .markov_samples = 300.0};
  const NoiseSpectrum values = means.of_single_values(kCount);
  for (const double angle_of_means : {0.001, 0.01, 0.05}) {
    const auto density_at = [](const NoiseSpectrum& noise, double angle) {
      return noise.density(2.0 * std::sin(0.5 * angle), 0, kMeans);
    };
    // A density a second is one a value times the period. Sines and exponentials are straight to
    // the square of the angle.
    EXPECT_NEAR(density_at(values, angle_of_means / kCount) / kCount,
                density_at(means, angle_of_means), 2e-3 * density_at(means, angle_of_means))
        << angle_of_means;
  }
}

TEST(SpectralBins, HoldEveryCoefficientButTheMean) {
  const auto bins = expected_bins({.white_variance = 1.0});
  double count = 0.0;
  for (const SpectralBin& bin : bins) count += bin.count;
  EXPECT_EQ(count, static_cast<double>(kSize - 1));
}

}  // namespace
}  // namespace zerorate::diagnose

/// @file
/// The density of a noise spectrum at a bin, part by part, with its derivatives: what the fit of
/// noise_spectrum.hpp climbs on.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"

namespace zerorate::diagnose {

/// Coefficients that stand alone, with their exact ratio to the nominal density.
inline constexpr std::size_t kSingleBins = 48;

inline constexpr int kMostParameters = 10;

/// One entry a fitted parameter: the logarithms of r and s_f^2, d, log k^2, log g and log tau, log
/// h, the logit of w0 / pi and the logarithm of the line's coherence time, the logit of a; those of
/// the terms that a fit has.
using SpectrumSlope = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostParameters, 1>;

/// What is the same for all spectra at one bin.
struct SpectralPlace {
  /// @param at, of, in as sine, index and size of NoiseSpectrum::density
  /// @param count of the coefficients in the bin
  /// @param has_line  the angle, which nothing else needs, is known
  SpectralPlace(double at, std::size_t of, std::size_t in, double count, bool has_line);

  double sine;
  double log_sine;
  double angle;
  double width;  ///< of the bin, an angle
  std::size_t index;
  std::size_t size;
};

/// What is the same for one spectrum at all bins.
class DensityFactors {
 public:
  /// @param spectrum must outlive the factors
  explicit DensityFactors(const NoiseSpectrum& spectrum);

  [[nodiscard]] const NoiseSpectrum& spectrum() const { return *spectrum_; }
  /// As of NoiseSpectrum.
  [[nodiscard]] double density(double sine, std::size_t index, std::size_t size) const;
  [[nodiscard]] double line_density(double angle, double width) const;
  [[nodiscard]] double low_pass_gain(double sine) const;

 private:
  friend class NoiseDensity;

  const NoiseSpectrum* spectrum_;
  double markov_phi_ = 0.0;
  double markov_lost_ = 0.0;  ///< 1 - phi
  double line_decay_ = 0.0;   ///< 1 / coherence time
  double line_coth_ = 0.0;    ///< of half the decay
  double line_sinh_ = 0.0;    ///< of the decay
  double line_cosh_ = 0.0;
  double cut_off_ = 0.0;  ///< tan(pi a / 2)
};

/// The parts of a spectrum at one bin and the derivatives of its logarithm.
class NoiseDensity {
 public:
  /// @param factors, place must outlive the density
  NoiseDensity(const DensityFactors& factors, const SpectralPlace& place);

  [[nodiscard]] double total() const {
    return pass_ * inner() + line_ + factors_->spectrum().rounding_variance;
  }

  /// @param slope as long as there are parameters
  void derivatives(const NoiseTerms& terms, SpectrumSlope& slope) const;

 private:
  [[nodiscard]] double inner() const { return white_ + flicker_ + walk_ + markov_; }
  [[nodiscard]] double low_pass_slope() const;
  void add_markov();

  const DensityFactors* factors_;
  const SpectralPlace* place_;
  double white_ = 0.0;
  double flicker_ = 0.0;
  double walk_ = 0.0;
  double markov_ = 0.0;
  double markov_slope_ = 0.0;
  double line_ = 0.0;
  double pass_ = 1.0;
};

}  // namespace zerorate::diagnose

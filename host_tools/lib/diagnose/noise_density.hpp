/// @file
/// The density of a noise spectrum at a bin, part by part, with its derivatives: what the fit of
/// noise_spectrum.hpp climbs on.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "host_tools/lib/diagnose/noise_spectrum.hpp"

namespace zerorate::diagnose {

/// Coefficients that stand alone, with their exact ratio to the nominal density.
inline constexpr std::size_t kSingleBins = 48;

inline constexpr int kMostParameters = 10;

/// One entry a fitted parameter: the logarithms of r and s_f^2, d, log k^2, log g and log tau, log
/// h, the logit of w0 / pi and the logarithm of the line's coherence time, the logit of a; those of
/// the terms that a fit has.
using SpectrumSlope = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostParameters, 1>;

/// The parts of a spectrum at one bin and the derivatives of its logarithm.
class NoiseDensity {
 public:
  /// @param spectrum must outlive the density
  /// @param sine, index, size as of NoiseSpectrum::density  @param count of the coefficients in the
  /// bin
  NoiseDensity(const NoiseSpectrum& spectrum, double sine, std::size_t index, std::size_t size,
               double count = 1.0);

  [[nodiscard]] double total() const {
    return pass_ * inner() + line_ + spectrum_->rounding_variance;
  }

  /// @param slope as long as there are parameters
  void derivatives(const NoiseTerms& terms, SpectrumSlope& slope) const;

 private:
  [[nodiscard]] double inner() const { return white_ + flicker_ + walk_ + markov_; }
  [[nodiscard]] double low_pass_slope() const;
  void add_markov(std::size_t index, std::size_t size);

  const NoiseSpectrum* spectrum_;
  double sine_;
  double angle_;
  double width_;
  double white_ = 0.0;
  double flicker_ = 0.0;
  double walk_ = 0.0;
  double markov_ = 0.0;
  double markov_slope_ = 0.0;
  double line_ = 0.0;
  double pass_ = 1.0;
};

}  // namespace zerorate::diagnose

/// @file
/// The density of a noise spectrum at a bin, part by part, with its derivatives: what the fit of
/// spectrum_fit.hpp climbs on.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/noise_parameters.hpp"
#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"

namespace zerorate::diagnose {

/// Derivatives of the logarithm of a density by each of kNoiseParameters on its scale; those of
/// terms that are not fitted are 0.
using NoiseSlopes = std::array<double, kNoiseParameters.size()>;

/// A bin, with the figures that do not depend on the spectrum.
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

/// A spectrum, with the figures that do not depend on the bin.
class DensityFactors {
 public:
  /// @param spectrum must outlive the factors
  explicit DensityFactors(const NoiseSpectrum& spectrum);

  [[nodiscard]] const NoiseSpectrum& spectrum() const { return *spectrum_; }
  /// Functions of the same names as those of NoiseSpectrum.
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

  /// Sets the derivatives that these terms need.
  void derivatives(const NoiseTerms& terms, NoiseSlopes& slopes) const;

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

/// Densities S_0 .. S_{end-1} of a spectrum; S_0 is infinite. Above the lowest frequencies they are
/// interpolated between nodes, to five digits.
/// @param sines  2 sin(w/2) of all coefficients of the record
[[nodiscard]] std::vector<double> density_table(const NoiseSpectrum& spectrum,
                                                std::span<const double> sines, std::size_t end);

}  // namespace zerorate::diagnose

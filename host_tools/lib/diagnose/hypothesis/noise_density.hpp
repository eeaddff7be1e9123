/// @file
/// The density of a noise spectrum at a bin, part by part, with the derivatives for the fit of
/// spectrum_fit.hpp.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/noise_parameters.hpp"
#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"

namespace zerorate::diagnose {

/// Derivatives of the logarithm of a density by each of kNoiseParameters on its scale; those of
/// terms that are not fitted are 0.
using NoiseSlopes = std::array<double, kNoiseParameters.size()>;

/// A band of angles. Its ends relative to a line follow by a sum of angles, which costs no sine.
struct AngularBand {
  AngularBand(double centre, double whole_width);

  std::complex<double> half_centre;    ///< e^(i centre / 2)
  std::complex<double> quarter_width;  ///< e^(i width / 4)
  double width;
};

/// A bin, with the figures that do not depend on the spectrum.
struct SpectralPlace {
  /// @param at, of, in as sine, index and size of NoiseSpectrum::density
  /// @param count of the coefficients in the bin
  /// @param has_line  the band, which nothing else needs, is known
  SpectralPlace(double at, std::size_t of, std::size_t in, double count, bool has_line);

  double sine;
  double log_sine;
  std::optional<AngularBand> band;
  std::size_t index;
  std::size_t size;
};

/// One side of a line, whose density at the distance x from its centre is Poisson's kernel,
/// sinh(k) / (cosh(k) - cos(x)), k = 1 / coherence time: its mean over a band, in closed form. The
/// integral of the kernel is 2 atan(coth(k/2) tan(x/2)); the difference at the ends of a band
/// below a whole turn is one angle.
class LineSide {
 public:
  /// @param coth of k / 2
  /// @param half_distance  e^(i x / 2) at the centre of the band
  LineSide(double coth, std::complex<double> half_distance, const AngularBand& band);

  [[nodiscard]] double mean() const;
  [[nodiscard]] double slope_of_distance(double sinh, double cosh) const;
  [[nodiscard]] double slope_of_log_coherence(double decay) const;

 private:
  [[nodiscard]] double slope_of_coth(std::complex<double> half) const;

  double coth_;
  double width_;
  double sine_of_half_width_;
  std::complex<double> lo_;  ///< e^(i x / 2) at the ends of the band
  std::complex<double> hi_;
};

/// Both sides, at the distances of a band from the line and from its mirror image.
struct LineSides {
  LineSide below;
  LineSide above;

  [[nodiscard]] double mean() const { return 0.5 * (below.mean() + above.mean()); }
};

/// A spectrum, with the figures that do not depend on the bin.
class DensityFactors {
 public:
  /// @param spectrum must outlive the factors
  explicit DensityFactors(const NoiseSpectrum& spectrum);

  [[nodiscard]] const NoiseSpectrum& spectrum() const { return *spectrum_; }
  /// Functions of the same names as those of NoiseSpectrum.
  [[nodiscard]] double density(double sine, std::size_t index, std::size_t size) const;
  [[nodiscard]] double low_pass_gain(double sine) const;
  /// Sides of the line, which the spectrum has.
  [[nodiscard]] LineSides line_sides(const AngularBand& band) const;

 private:
  friend class NoiseDensity;

  const NoiseSpectrum* spectrum_;
  double markov_phi_ = 0.0;
  double markov_lost_ = 0.0;  ///< 1 - phi
  double line_decay_ = 0.0;   ///< 1 / coherence time
  double line_coth_ = 0.0;    ///< coth of half the decay
  double line_sinh_ = 0.0;    ///< sinh of the decay
  double line_cosh_ = 0.0;
  std::complex<double> half_line_angle_ = 1.0;  ///< e^(i w0 / 2)
  double cut_off_ = 0.0;                        ///< tan(pi a / 2)
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
  std::optional<LineSides> line_sides_;
  double line_ = 0.0;
  double pass_ = 1.0;
};

/// Densities S_0 .. S_{end-1} of a spectrum; S_0 is infinite. Above the lowest frequencies they are
/// interpolated between nodes, to five digits.
/// @param sines  2 sin(w/2) of all coefficients of the record
[[nodiscard]] std::vector<double> density_table(const NoiseSpectrum& spectrum,
                                                std::span<const double> sines, std::size_t end);

}  // namespace zerorate::diagnose

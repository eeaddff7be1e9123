/// @file
/// The spectrum of the noise of one axis: base noise, what may be added to it, and its fit to the
/// DCT-II of a record (docs/design/diagnosis.md, section 2).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace zerorate::diagnose {

/// Of 1/f noise, that of the base model.
inline constexpr double kOrderOfBase = 0.5;

/// Which parts a spectrum has besides white and flicker noise.
struct NoiseTerms {
  bool free_order = false;  ///< d is fitted; else it is the one given, or 1/2
  bool random_walk = false;
  bool gauss_markov = false;
  bool line = false;
  bool low_pass = false;
  std::optional<double> given_order{};

  [[nodiscard]] NoiseTerms operator|(const NoiseTerms& other) const {
    return {free_order || other.free_order,     random_walk || other.random_walk,
            gauss_markov || other.gauss_markov, line || other.line,
            low_pass || other.low_pass,         given_order ? given_order : other.given_order};
  }
  [[nodiscard]] bool has_order() const { return free_order || given_order; }
  /// Has slow noise other than the base's, which takes in whatever a wrong function of time leaves.
  [[nodiscard]] bool wanders() const { return has_order() || random_walk || gauss_markov; }
  bool operator==(const NoiseTerms&) const = default;
};

/// Two-sided density per sample at angular frequency w, with s = 2 sin(w/2):
///
///     S = H (r + s_f^2 s^(-2d) + k^2 s^(-2) + g (1 - phi^2) / ((1-phi)^2 + phi s^2)) + L + q,
///     phi = exp(-1 / tau).
///
/// L is a line of finite width, a Gauss-Markov process of variance h moved to both sides of w0; it
/// stands behind the low-pass, as it is measured.
///
/// The low-pass is either y += a (x - y), H = a^2 / (a^2 + (1-a) s^2), or the mean of two
/// neighbours, weighted, H = 1 - (1-a) s^2 / 4, as of a window a little longer than the sample
/// period, or a Butterworth filter of order m by the bilinear transform, H = 1 / (1 + (tan(w/2) /
/// tan(pi a / 2))^(2m)).
struct NoiseSpectrum {
  static constexpr int kRecursive = 0;
  static constexpr int kTwoNeighbours = -1;

  double white_variance = 0.0;    ///< r
  double flicker_variance = 0.0;  ///< s_f^2
  double order = kOrderOfBase;    ///< d
  double walk_variance = 0.0;     ///< k^2, of one step
  double markov_variance = 0.0;   ///< g
  double markov_samples = 1.0;    ///< tau
  double line_variance = 0.0;     ///< h
  double line_angle = 1.0;        ///< w0, between 0 and pi
  double line_samples = 100.0;    ///< its coherence time
  double low_pass_share = 1.0;    ///< a; 1: no low-pass. Of a Butterworth filter: of half the rate
  int low_pass_order = kRecursive;  ///< m, or one of the constants
  double rounding_variance = 0.0;   ///< q, behind the low-pass: given, not fitted

  /// H.
  [[nodiscard]] double low_pass_gain(double sine) const;
  /// L, its mean over a band of angles.
  [[nodiscard]] double line_density(double angle, double width) const;
  /// @param sine s  @param index k of the DCT coefficient, for what is exact at the lowest ones
  /// @param size of the record
  [[nodiscard]] double density(double sine, std::size_t index, std::size_t size) const;
};

/// Neighbouring DCT coefficients of nearly the same density.
struct SpectralBin {
  double sine;  ///< 2 sin(w/2) at the centre
  double mean_square;
  double count;
  std::size_t index;  ///< of the coefficient where it stands alone, else 0
};

/// One bin for each of the first coefficients, 3 % wide ones above; towards the last coefficient,
/// where a low-pass may end in nothing, they are no wider than a tenth of what is left up to it,
/// and no wider than a tenth of the distance to a line.
/// @param coefficients c_0 .. c_{n-1}; c_0 is left out
/// @param line  index of the coefficient where a line stands; 0: none
[[nodiscard]] std::vector<SpectralBin> bin_coefficients(std::span<const double> coefficients,
                                                        std::size_t line = 0);

/// Brings bins up to date with coefficients of which those below `end` have changed.
void update_bins(std::span<SpectralBin> bins, std::span<const double> coefficients,
                 std::size_t end);

/// Standard errors of the logarithms of strengths and times, of d and w0, and of the logit of a;
/// those of the expected information. 0 where a parameter is not fitted.
struct NoiseErrors {
  double log_white_variance = 0.0;
  double log_flicker_variance = 0.0;
  double order = 0.0;
  double log_walk_variance = 0.0;
  double log_markov_variance = 0.0;
  double log_markov_samples = 0.0;
  double log_line_variance = 0.0;
  double line_angle = 0.0;
  double log_line_samples = 0.0;
  double logit_low_pass_share = 0.0;
};

struct SpectrumFit {
  NoiseSpectrum spectrum;
  double log_likelihood = 0.0;  ///< -1/2 sum log S_k + c_k^2 / S_k
  NoiseErrors errors;
};

/// Maximises the Whittle likelihood by Fisher scoring with analytic derivatives from each start;
/// the best one counts, with its kind of low-pass. Some 20 us an iteration.
/// @param size of the record
[[nodiscard]] SpectrumFit fit_spectrum(std::span<const SpectralBin> bins, std::size_t size,
                                       const NoiseTerms& terms,
                                       std::span<const NoiseSpectrum> starts);

/// A start for white and flicker noise alone.
[[nodiscard]] NoiseSpectrum rough_spectrum(std::span<const SpectralBin> bins);

}  // namespace zerorate::diagnose

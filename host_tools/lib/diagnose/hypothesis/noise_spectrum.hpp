/// @file
/// The spectrum of the noise of one axis: white and flicker noise, and the terms that may be added
/// (docs/design/diagnosis.md, section 2).
#pragma once

#include <cstddef>
#include <optional>

namespace zerorate::diagnose {

/// Order of 1/f noise, which the base model has.
inline constexpr double kOrderOfBase = 0.5;

/// Parts of a spectrum besides white and flicker noise.
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
  /// Whether there is slow noise besides the base's. Such noise absorbs the residue of a wrong
  /// function of time.
  [[nodiscard]] bool has_slow_noise() const { return has_order() || random_walk || gauss_markov; }
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

  double white_variance = 0.0;          ///< r
  double flicker_variance = 0.0;        ///< s_f^2
  double flicker_order = kOrderOfBase;  ///< d
  double walk_variance = 0.0;           ///< k^2, of one step
  double markov_variance = 0.0;         ///< g
  double markov_samples = 1.0;          ///< tau
  double line_variance = 0.0;           ///< h
  double line_angle = 1.0;              ///< w0, between 0 and pi
  double line_samples = 100.0;          ///< its coherence time
  double low_pass_share = 1.0;     ///< a; 1: no low-pass. Of a Butterworth filter: of half the rate
  int filter_order = kRecursive;   ///< m, or one of the constants
  double rounding_variance = 0.0;  ///< q, behind the low-pass: given, not fitted

  /// The noise of single values, where this is that of means over `count` of them: the density at
  /// frequencies that both have is the same.
  [[nodiscard]] NoiseSpectrum of_single_values(double count) const;
  /// H.
  [[nodiscard]] double low_pass_gain(double sine) const;
  /// L, its mean over a band of angles.
  [[nodiscard]] double line_density(double angle, double width) const;
  /// @param sine s  @param index k of the DCT coefficient, for what is exact at the lowest ones
  /// @param size of the record
  [[nodiscard]] double density(double sine, std::size_t index, std::size_t size) const;
};

}  // namespace zerorate::diagnose

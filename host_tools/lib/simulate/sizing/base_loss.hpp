/// @file
/// Loss of the best base model, white + 1/f + constant, against the truth: expected log likelihood
/// in nats, on the grid of the DCT-II, where the noise of a record is very nearly white and a
/// constant is the one coefficient that is left out.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace zerorate::sizing {

/// Variances of the coefficients 1 .. n-1 of the orthonormal DCT-II, rad^2/s^2.
using Spectrum = std::vector<double>;

/// Noise of unit strength.
[[nodiscard]] Spectrum flat_spectrum(std::size_t samples);
/// ARFIMA(0,d,0) with unit innovations. The lowest coefficients have their exact variance in a
/// process that is stationary in its increments, which for d = 1/2 is 0.77, 0.90, 0.93 .. of the
/// density at their frequency. d = 1 is the random walk.
[[nodiscard]] Spectrum fractional_spectrum(std::size_t samples, double order);
/// First-order Gauss-Markov noise of unit variance.
[[nodiscard]] Spectrum gauss_markov_spectrum(std::size_t samples, double time_constant_samples);
/// Squared gain of the low-pass y += share (x - y).
[[nodiscard]] Spectrum low_pass_gain(std::size_t samples, double share);

/// Coefficients 1 .. n-1 of a mean function; its last few values are left out where the transform
/// wants another length (spectrum::fast_length_below).
[[nodiscard]] std::vector<double> contrasts(std::span<const double> mean);

/// The least over non-negative weights of sum (ln B_k + P_k / B_k) / 2, B the weighted sum of
/// shapes: the expected -log likelihood, but for a constant, of the best model of a family when
/// the coefficients have the second moments P. Fisher scoring with step halving, O(n) a step.
struct BestFit {
  std::vector<double> weights;
  double cost_nats = 0.0;
};
[[nodiscard]] BestFit best_fit(std::span<const double> second_moments,
                               std::span<const Spectrum> shapes, std::vector<double> start_weights);

/// sum (ln T_k + P_k / T_k) / 2: the same cost of the truth.
[[nodiscard]] double cost_nats(std::span<const double> second_moments, const Spectrum& truth);

/// Product of two mean functions' contrasts in the metric of a noise: sum a_k b_k / T_k.
[[nodiscard]] double inner(const Spectrum& noise, std::span<const double> a,
                           std::span<const double> b);
/// Contrasts of a mean function without what others describe, by generalised least squares.
/// @param others  contrasts, linearly independent
[[nodiscard]] std::vector<double> beyond(const Spectrum& noise, std::vector<double> contrasts,
                                         std::vector<std::vector<double>> others);

/// Noise of a recording, and what the best model of a family makes of an effect that the family
/// does not know. The family begins as the base model, white and flicker noise of free strengths.
/// It grows by each effect that is said to be known: then a loss is that beside those effects.
class BaseNoise {
 public:
  /// @param white_sigma, flicker_sigma  of a sample and of an innovation, rad/s
  BaseNoise(std::size_t samples, double white_sigma, double flicker_sigma);

  /// Noise with a known spectrum more, whose strength is free.
  /// @param shape     in front of the sensor's low-pass
  /// @param variance  by which the shape is multiplied
  [[nodiscard]] BaseNoise with_noise(const Spectrum& shape, double variance) const;
  /// Noise with more of its white noise.
  [[nodiscard]] BaseNoise with_white_noise(double variance) const;
  /// Noise with another flicker noise in place of its own.
  [[nodiscard]] BaseNoise with_flicker_noise(const Spectrum& shape, double variance) const;
  /// Noise behind a low-pass.
  [[nodiscard]] BaseNoise behind(const Spectrum& gain) const;
  /// Noise beside a mean function of known shape, whose size is free.
  [[nodiscard]] BaseNoise beside_mean(std::vector<double> contrasts) const;

  [[nodiscard]] std::size_t samples() const { return spectrum_.size() + 1; }
  /// White noise of a sample, as the low-pass leaves it [rad/s].
  [[nodiscard]] double white_sigma() const;
  [[nodiscard]] const Spectrum& spectrum() const { return spectrum_; }
  /// Variance of the best prediction's error one sample ahead: Kolmogorov's formula.
  [[nodiscard]] double innovation_variance() const;
  /// sum c_k^2 / T_k of a mean function's contrasts: twice what knowing it is worth.
  [[nodiscard]] double squared_norm(std::span<const double> contrasts) const {
    return inner(spectrum_, contrasts, contrasts);
  }

  /// Loss where the noise itself is another: expected Kullback-Leibler divergence. A known mean
  /// takes one coefficient of a record and is left out of account.
  [[nodiscard]] double loss_to_spectrum(const Spectrum& truth) const;
  /// Loss where a mean function is added to the noise. The family may take it for noise, or for
  /// the means that it knows.
  [[nodiscard]] double loss_to_mean(std::span<const double> contrasts) const;
  /// Loss to a family that has a random walk as well.
  [[nodiscard]] double loss_with_walk_to_mean(std::span<const double> contrasts) const;

 private:
  void mix();

  std::vector<Spectrum> shapes_;   ///< white noise, flicker noise, and what else is known
  std::vector<double> variances_;  ///< true variances of the shapes
  Spectrum gain_;                  ///< gain of the low-pass, 1 without
  std::vector<std::vector<double>> means_;
  Spectrum spectrum_;
};

}  // namespace zerorate::sizing

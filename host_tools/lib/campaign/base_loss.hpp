/// @file
/// Loss of the best base model, white + 1/f + constant, against the truth: expected log likelihood
/// in nats, on the grid of the DCT-II, where the noise of a record is very nearly white and a
/// constant is the one coefficient that is left out.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace zerorate::campaign {

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

/// The noise that every recording has, and what the base model makes of it.
class BaseNoise {
 public:
  /// @param white_sigma, flicker_sigma  of a sample and of an innovation, rad/s
  BaseNoise(std::size_t samples, double white_sigma, double flicker_sigma);

  [[nodiscard]] std::size_t samples() const { return shapes_.front().size() + 1; }
  [[nodiscard]] double white_sigma() const { return white_sigma_; }
  [[nodiscard]] const Spectrum& spectrum() const { return spectrum_; }
  /// Variance of the best prediction's error one sample ahead: Kolmogorov's formula.
  [[nodiscard]] double innovation_variance() const;
  /// sum c_k^2 / T_k of a mean function's contrasts: twice what knowing it is worth.
  [[nodiscard]] double squared_norm(std::span<const double> contrasts) const;

  /// Loss where the noise itself is another: expected Kullback-Leibler divergence.
  [[nodiscard]] double loss_to_spectrum(const Spectrum& truth) const;
  /// Loss where a mean function is added to the base noise. The base may take it for noise.
  [[nodiscard]] double loss_to_mean(std::span<const double> contrasts) const;
  /// Loss to a family that has a random walk as well.
  [[nodiscard]] double loss_with_walk_to_mean(std::span<const double> contrasts) const;

 private:
  [[nodiscard]] double loss(std::span<const double> contrasts,
                            std::span<const Spectrum> shapes) const;

  double white_sigma_;
  double flicker_sigma_;
  std::vector<Spectrum> shapes_;
  Spectrum walk_;
  Spectrum spectrum_;
};

}  // namespace zerorate::campaign

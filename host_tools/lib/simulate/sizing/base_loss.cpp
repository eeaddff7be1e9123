#include "host_tools/lib/simulate/sizing/base_loss.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::sizing {
namespace {

using std::numbers::pi;

double cycles_per_sample(std::size_t coefficient, std::size_t samples) {
  return 0.5 * static_cast<double>(coefficient) / static_cast<double>(samples);
}

template <class Density>
Spectrum on_grid(std::size_t samples, Density density) {
  Spectrum spectrum(samples - 1);
  for (std::size_t k = 1; k < samples; ++k) {
    spectrum[k - 1] = density(cycles_per_sample(k, samples));
  }
  return spectrum;
}

/// Variance of coefficient k over the density |omega|^(-2d) at omega = pi k, for a record of unit
/// length: the integral of the density times the squared transform of sqrt(2) cos(pi k t),
///   2 omega^2 |1 - (-1)^k exp(-i omega)|^2 / (omega^2 - pi^2 k^2)^2, over 2 pi.
double low_coefficient_ratio(int k, double order) {
  constexpr int kStepsPerPi = 400;
  constexpr int kUpTo = 200;  // in units of pi; the integrand falls as omega^(-2-2d)
  const double step = pi / kStepsPerPi;
  const double peak = pi * k;
  double sum = 0.0;
  for (int i = 0; i < kUpTo * kStepsPerPi; ++i) {
    const double omega = (i + 0.5) * step;
    const double turn = k % 2 == 0 ? std::sin(0.5 * omega) : std::cos(0.5 * omega);
    const double window = omega * 2.0 * turn / ((omega - peak) * (omega + peak));
    sum += std::pow(omega / peak, -2.0 * order) * 2.0 * window * window;
  }
  return sum * step / pi;  // both signs of omega
}

struct Quadratic {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd slope;
};

/// The least non-negative w of w'Hw/2 - s'w, by trying every set of weights that are not zero.
Eigen::VectorXd non_negative_minimum(const Quadratic& q) {
  const auto n = static_cast<unsigned>(q.slope.size());
  Eigen::VectorXd best = Eigen::VectorXd::Zero(q.slope.size());
  double least = std::numeric_limits<double>::infinity();
  for (unsigned set = 1; set < (1U << n); ++set) {
    std::vector<Eigen::Index> chosen;
    for (unsigned i = 0; i < n; ++i) {
      if ((set >> i & 1U) != 0) chosen.push_back(static_cast<Eigen::Index>(i));
    }
    const Eigen::VectorXd part = q.hessian(chosen, chosen).ldlt().solve(q.slope(chosen));
    if (!(part.minCoeff() >= 0.0)) continue;
    const double value = -0.5 * part.dot(q.slope(chosen));
    if (value >= least) continue;
    least = value;
    best.setZero();
    best(chosen) = part;
  }
  return best;
}

constexpr std::size_t kWhite = 0;
constexpr std::size_t kFlicker = 1;

Spectrum product(Spectrum a, const Spectrum& b) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] *= b[k];
  return a;
}

Spectrum mixture(std::span<const Spectrum> shapes, const Eigen::VectorXd& weights) {
  Spectrum sum(shapes.front().size(), 0.0);
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const double weight = weights(static_cast<Eigen::Index>(s));
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * shapes[s][k];
  }
  return sum;
}

/// Fisher's quadratic of the cost around a model, in which the weights are linear.
Quadratic scoring(std::span<const double> second_moments, std::span<const Spectrum> shapes,
                  const Spectrum& model) {
  const auto n = static_cast<Eigen::Index>(shapes.size());
  Quadratic q{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (std::size_t k = 0; k < model.size(); ++k) {
    const double weight = 1.0 / (model[k] * model[k]);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double shape = shapes[static_cast<std::size_t>(i)][k];
      q.slope(i) += weight * shape * second_moments[k];
      for (Eigen::Index j = 0; j <= i; ++j) {
        q.hessian(i, j) += weight * shape * shapes[static_cast<std::size_t>(j)][k];
      }
    }
  }
  q.hessian = q.hessian.selfadjointView<Eigen::Lower>();
  return q;
}

}  // namespace

Spectrum flat_spectrum(std::size_t samples) {
  return Spectrum(samples - 1, 1.0);
}

Spectrum fractional_spectrum(std::size_t samples, double order) {
  Spectrum spectrum =
      on_grid(samples, [order](double f) { return spectrum::fractional_density(order, f); });
  constexpr int kLowest = 8;
  for (int k = 1; k <= kLowest && order < 1.0; ++k) {
    spectrum[static_cast<std::size_t>(k) - 1] *= low_coefficient_ratio(k, order);
  }
  return spectrum;
}

Spectrum gauss_markov_spectrum(std::size_t samples, double time_constant_samples) {
  const double decay = std::exp(-1.0 / time_constant_samples);
  return on_grid(samples, [decay](double f) {
    return (1.0 - decay * decay) / (1.0 + decay * decay - 2.0 * decay * std::cos(2.0 * pi * f));
  });
}

Spectrum low_pass_gain(std::size_t samples, double share) {
  const double kept = 1.0 - share;
  return on_grid(samples, [share, kept](double f) {
    return share * share / (1.0 + kept * kept - 2.0 * kept * std::cos(2.0 * pi * f));
  });
}

std::vector<double> contrasts(std::span<const double> mean) {
  std::vector<double> coefficients =
      spectrum::cosine_transform(mean.first(spectrum::fast_length_below(mean.size())));
  coefficients.erase(coefficients.begin());
  return coefficients;
}

double cost_nats(std::span<const double> second_moments, const Spectrum& truth) {
  double sum = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    sum += std::log(truth[k]) + second_moments[k] / truth[k];
  }
  return 0.5 * sum;
}

BestFit best_fit(std::span<const double> second_moments, std::span<const Spectrum> shapes,
                 std::vector<double> start_weights) {
  constexpr int kMostSteps = 60;
  constexpr double kEnoughNats = 1e-4;
  Eigen::VectorXd weights = Eigen::Map<const Eigen::VectorXd>(
      start_weights.data(), static_cast<Eigen::Index>(start_weights.size()));
  Spectrum model = mixture(shapes, weights);
  double cost = cost_nats(second_moments, model);
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::VectorXd towards = non_negative_minimum(scoring(second_moments, shapes, model));
    double gained = 0.0;
    for (double share = 1.0; share > 1e-4; share *= 0.5) {
      const Eigen::VectorXd trial = weights + share * (towards - weights);
      Spectrum trial_model = mixture(shapes, trial);
      if (std::ranges::min(trial_model) <= 0.0) continue;
      const double trial_cost = cost_nats(second_moments, trial_model);
      if (!(trial_cost < cost)) continue;
      gained = cost - trial_cost;
      weights = trial;
      model = std::move(trial_model);
      cost = trial_cost;
      break;
    }
    if (gained < kEnoughNats) break;
  }
  return {std::vector<double>(weights.begin(), weights.end()), cost};
}

double inner(const Spectrum& noise, std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < noise.size(); ++k) sum += a[k] * b[k] / noise[k];
  return sum;
}

std::vector<double> beyond(const Spectrum& noise, std::vector<double> contrasts,
                           std::vector<std::vector<double>> others) {
  const auto take = [&](const std::vector<double>& other, std::vector<double>& from) {
    const double share = inner(noise, from, other) / inner(noise, other, other);
    for (std::size_t k = 0; k < from.size(); ++k) from[k] -= share * other[k];
  };
  for (std::size_t i = 0; i < others.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) take(others[j], others[i]);
    take(others[i], contrasts);
  }
  return contrasts;
}

BaseNoise::BaseNoise(std::size_t samples, double white_sigma, double flicker_sigma)
    : shapes_{flat_spectrum(samples), fractional_spectrum(samples, 0.5)},
      variances_{white_sigma * white_sigma, flicker_sigma * flicker_sigma},
      gain_(flat_spectrum(samples)) {
  mix();
}

void BaseNoise::mix() {
  spectrum_ =
      mixture(shapes_, Eigen::Map<const Eigen::VectorXd>(
                           variances_.data(), static_cast<Eigen::Index>(variances_.size())));
}

BaseNoise BaseNoise::with_noise(const Spectrum& shape, double variance) const {
  BaseNoise more = *this;
  more.shapes_.push_back(product(shape, gain_));
  more.variances_.push_back(variance);
  more.mix();
  return more;
}

BaseNoise BaseNoise::with_white_noise(double variance) const {
  BaseNoise more = *this;
  more.variances_[kWhite] += variance;
  more.mix();
  return more;
}

BaseNoise BaseNoise::with_flicker_noise(const Spectrum& shape, double variance) const {
  BaseNoise other = *this;
  other.shapes_[kFlicker] = product(shape, gain_);
  other.variances_[kFlicker] = variance;
  other.mix();
  return other;
}

BaseNoise BaseNoise::behind(const Spectrum& gain) const {
  BaseNoise passed = *this;
  for (Spectrum& shape : passed.shapes_) shape = product(shape, gain);
  passed.gain_ = product(gain_, gain);
  passed.mix();
  return passed;
}

BaseNoise BaseNoise::beside_mean(std::vector<double> contrasts) const {
  BaseNoise beside = *this;
  beside.means_.push_back(std::move(contrasts));
  return beside;
}

double BaseNoise::white_sigma() const {
  double sum = 0.0;
  for (const double share : shapes_[kWhite]) sum += share;
  return std::sqrt(variances_[kWhite] * sum / static_cast<double>(spectrum_.size()));
}

double BaseNoise::innovation_variance() const {
  double sum = 0.0;
  for (const double variance : spectrum_) sum += std::log(variance);
  return std::exp(sum / static_cast<double>(spectrum_.size()));
}

double BaseNoise::loss_to_spectrum(const Spectrum& truth) const {
  return best_fit(truth, shapes_, variances_).cost_nats - cost_nats(truth, truth);
}

double BaseNoise::loss_to_mean(std::span<const double> contrasts) const {
  const std::vector<double> left = beyond(spectrum_, {contrasts.begin(), contrasts.end()}, means_);
  std::vector<double> second_moments = spectrum_;
  for (std::size_t k = 0; k < second_moments.size(); ++k) second_moments[k] += left[k] * left[k];
  return best_fit(second_moments, shapes_, variances_).cost_nats - cost_nats(spectrum_, spectrum_);
}

double BaseNoise::loss_with_walk_to_mean(std::span<const double> contrasts) const {
  return with_noise(fractional_spectrum(samples(), 1.0), 0.0).loss_to_mean(contrasts);
}

}  // namespace zerorate::sizing

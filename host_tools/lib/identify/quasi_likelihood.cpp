#include "host_tools/lib/identify/quasi_likelihood.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/model/flicker_fit.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPi = std::numbers::pi;

/// Density per tick of the mean of `samples` samples of fractional noise of this order, whose
/// innovation variance at the tick would be one. The mean has the gain sin(pi n g) / (n sin(pi g))
/// at g cycles per sample, and folds g = (f + k) / n onto f.
double density_of_mean(double order, int samples, double cycles_per_tick) {
  // The shares fall like |k|^(-2 - 2d): those further away are below 1 % of the whole.
  constexpr int kFarthest = 16;
  const int lowest = -std::min(kFarthest, (samples - 1) / 2);
  const int highest = std::min(kFarthest, samples / 2);
  const double n = samples;
  double sum = 0.0;
  for (int k = lowest; k <= highest; ++k) {
    const double g = std::abs(cycles_per_tick + k) / n;
    const double gain = std::sin(kPi * cycles_per_tick) / (n * std::sin(kPi * g));
    sum += gain * gain * spectrum::fractional_density(order, g);
  }
  return std::pow(n, -2.0 * order) * sum;
}

/// One of the Fourier frequencies, or many that lie together.
struct WeighedFrequency {
  double cycles_per_tick;
  double weight;
};

std::vector<WeighedFrequency> fourier_frequencies(double ticks) {
  constexpr double kPerOctave = 8.0;
  const double ratio = std::exp2(1.0 / kPerOctave);
  std::vector<WeighedFrequency> all;
  double low = 0.5;
  while (low < 0.5 * ticks) {
    const double high = std::min(0.5 * ticks, std::max(low + 1.0, low * ratio));
    all.push_back({0.5 * (low + high) / ticks, high - low});
    low = high;
  }
  return all;
}

using ModelAt = std::function<model::SensorModel(const VectorXd&)>;
using Density = std::function<double(const model::SensorModel&, double cycles_per_tick)>;

VectorXd densities(const Density& density, const model::SensorModel& model,
                   const std::vector<WeighedFrequency>& frequencies) {
  VectorXd all(static_cast<Eigen::Index>(frequencies.size()));
  std::ranges::transform(frequencies, all.begin(), [&](const WeighedFrequency& one) {
    return density(model, one.cycles_per_tick);
  });
  return all;
}

/// Derivatives of log densities by the parameters: a row a frequency.
MatrixXd slopes(const Density& density, const ModelAt& model_at, const VectorXd& at,
                const std::vector<WeighedFrequency>& frequencies) {
  constexpr double kStep = 1e-3;
  MatrixXd all(static_cast<Eigen::Index>(frequencies.size()), at.size());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const VectorXd step = kStep * VectorXd::Unit(at.size(), i);
    const VectorXd above = densities(density, model_at(at + step), frequencies);
    const VectorXd below = densities(density, model_at(at - step), frequencies);
    all.col(i) = (above.array() / below.array()).log() / (2.0 * kStep);
  }
  return all;
}

}  // namespace

TickSampling TickSampling::of(const InnovationsLikelihood& likelihood, double ticks) {
  // More samples a tick than this have the same mean.
  constexpr double kMany = 1000.0;
  const double tick_s = units::seconds(likelihood.tick().ns());
  const double samples = tick_s / units::seconds(likelihood.sample_period().ns());
  return {tick_s, static_cast<int>(std::lround(std::clamp(samples, 1.0, kMany))), ticks};
}

double filter_density(const model::SensorModel& model, double tick_s, double cycles_per_tick) {
  const double sine = std::sin(kPi * cycles_per_tick);
  double density = spectrum::white_variance(model.white.angle_random_walk_rad_per_sqrt_s, tick_s);
  if (model.flicker) {
    density += model::fit_flicker(*model.flicker, tick_s).density(tick_s, cycles_per_tick);
  }
  if (model.rate_random_walk) {
    const double k = model.rate_random_walk->coefficient_rad_s_per_sqrt_s;
    density += k * k * tick_s / (4.0 * sine * sine);
  }
  return density;
}

double noise_density(const model::SensorModel& model, double tick_s, int samples,
                     double cycles_per_tick) {
  double density = spectrum::white_variance(model.white.angle_random_walk_rad_per_sqrt_s, tick_s);
  if (model.flicker) {
    density += spectrum::flicker_innovation_variance(model.flicker->bias_instability_rad_s,
                                                     model.flicker->order, tick_s) *
               density_of_mean(model.flicker->order, samples, cycles_per_tick);
  }
  if (model.rate_random_walk) {
    const double k = model.rate_random_walk->coefficient_rad_s_per_sqrt_s;
    density += k * k * tick_s * density_of_mean(1.0, samples, cycles_per_tick);
  }
  return density;
}

FittedParameters noise_of_filter_fit(const ModelAt& model_at, const FittedParameters& of_filter,
                                     const TickSampling& sampling, const VectorXd& longest) {
  const std::vector<WeighedFrequency> frequencies = fourier_frequencies(sampling.ticks);
  const Density of_model = [&](const model::SensorModel& model, double f) {
    return filter_density(model, sampling.tick_s, f);
  };
  const Density of_noise = [&](const model::SensorModel& model, double f) {
    return noise_density(model, sampling.tick_s, sampling.samples, f);
  };
  VectorXd weights(static_cast<Eigen::Index>(frequencies.size()));
  std::ranges::transform(frequencies, weights.begin(), &WeighedFrequency::weight);

  const VectorXd held = densities(of_model, model_at(of_filter.at), frequencies);
  const MatrixXd filter_slopes = slopes(of_model, model_at, of_filter.at, frequencies);
  const MatrixXd weighed = weights.asDiagonal() * filter_slopes;
  const MatrixXd prior = longest.cwiseAbs2().cwiseInverse().asDiagonal();

  VectorXd at = of_filter.at;
  MatrixXd information;
  constexpr int kIterations = 8;
  for (int i = 0; i < kIterations; ++i) {
    const VectorXd ratio = densities(of_noise, model_at(at), frequencies).cwiseQuotient(held);
    information =
        weighed.transpose() * ratio.asDiagonal() * slopes(of_noise, model_at, at, frequencies) +
        prior;
    const VectorXd derivative = weighed.transpose() * (ratio.array() - 1.0).matrix();
    at -= information.partialPivLu().solve(derivative).cwiseMax(-longest).cwiseMin(longest);
  }
  const MatrixXd gain =
      information.partialPivLu().solve(filter_slopes.transpose() * weighed + prior);
  return {at, gain * of_filter.covariance * gain.transpose()};
}

}  // namespace zerorate::identify

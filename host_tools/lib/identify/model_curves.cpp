#include "host_tools/lib/identify/model_curves.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/model/flicker_fit.hpp"

namespace zerorate::identify {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// Allan variance of an exponentially correlated process of unit variance, a = tau / T.
double lag_allan_variance(double a) {
  // The series where the closed form would be a difference of nearly equal numbers.
  if (a < 1e-3) return 2.0 / 3.0 * a * (1.0 - 0.75 * a);
  return 2.0 / a * (1.0 - (3.0 - 4.0 * std::exp(-a) + std::exp(-2.0 * a)) / (2.0 * a));
}

}  // namespace

double model_density(const model::SensorModel& model, double frequency_hz) {
  const double white = model.white.angle_random_walk_rad_per_sqrt_s;
  double density = white * white;
  if (model.flicker) {
    const double b = model.flicker->bias_instability_rad_s;
    density += b * b * std::pow(kTwoPi * frequency_hz, -2.0 * model.flicker->order);
  }
  return density;
}

double model_allan_deviation(const model::SensorModel& model, double tau_s) {
  const double white = model.white.angle_random_walk_rad_per_sqrt_s;
  double variance = white * white / tau_s;
  if (model.flicker) {
    const auto decades =
        model::fit_flicker(*model.flicker, model.flicker->shortest_time_constant_s);
    for (std::size_t i = 0; i < decades.time_constants_s.size(); ++i) {
      variance +=
          decades.variances_rad2_s2[i] * lag_allan_variance(tau_s / decades.time_constants_s[i]);
    }
  }
  return std::sqrt(variance);
}

double corner_frequency_hz(const model::SensorModel& model) {
  const double ratio =
      model.flicker->bias_instability_rad_s / model.white.angle_random_walk_rad_per_sqrt_s;
  return std::pow(ratio, 1.0 / model.flicker->order) / kTwoPi;
}

}  // namespace zerorate::identify

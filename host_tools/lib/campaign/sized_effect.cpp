#include "host_tools/lib/campaign/sized_effect.hpp"

#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

namespace zerorate::campaign {

std::optional<double> size_for(const SizedEffect& effect, double nats) {
  const auto excess = [&](double log_size) { return effect.loss_nats(std::exp(log_size)) - nats; };
  constexpr int kMostDoublings = 30;
  const double start = std::log(effect.guess);
  const double direction = excess(start) < 0.0 ? std::log(2.0) : -std::log(2.0);
  double near = start;
  double far = start + direction;
  for (int i = 0; (excess(far) < 0.0) == (direction > 0.0); ++i, near = far, far += direction) {
    if (i == kMostDoublings) return std::nullopt;
  }
  std::uintmax_t most_evaluations = 40;
  const auto [lo, hi] = boost::math::tools::toms748_solve(
      excess, std::min(near, far), std::max(near, far),
      [](double a, double b) { return std::abs(b - a) < 1e-4; }, most_evaluations);
  return std::exp(hi);
}

std::span<const EffectEntry> catalogue() {
  static constexpr std::array<EffectEntry, kKnownEffects> kEntries = {
      EffectEntry{"rate_random_walk", draw_rate_random_walk},
      EffectEntry{"temperature_drift", draw_temperature_drift},
      EffectEntry{"temperature_rate", draw_temperature_rate},
      EffectEntry{"warm_up_transient", draw_warm_up_transient},
      EffectEntry{"rate_ramp", draw_rate_ramp},
      EffectEntry{"periodic_disturbance", draw_periodic_disturbance},
      EffectEntry{"quantization", draw_quantization},
      EffectEntry{"bias_jump", draw_bias_jump},
      EffectEntry{"relaxation", draw_relaxation},
      EffectEntry{"random_telegraph_noise", draw_random_telegraph_noise},
      EffectEntry{"fractional_order", draw_fractional_order},
      EffectEntry{"sensor_bandwidth", draw_sensor_bandwidth},
      EffectEntry{"correlated_noise", draw_correlated_noise},
      EffectEntry{"outliers", draw_outliers},
      EffectEntry{"dropped_samples", draw_dropped_samples},
      EffectEntry{"saturation", draw_saturation},
      EffectEntry{"motion_contamination", draw_motion_contamination},
      EffectEntry{"variable_noise", draw_variable_noise}};
  return kEntries;
}

std::span<const EffectEntry> outside_catalogue() {
  static constexpr std::array kEntries = {
      EffectEntry{"chirp", draw_chirp},
      EffectEntry{"temperature_hysteresis", draw_temperature_hysteresis},
      EffectEntry{"sawtooth", draw_sawtooth},
      EffectEntry{"burst_noise", draw_burst_noise},
      EffectEntry{"skewed_noise", draw_skewed_noise},
      EffectEntry{"deadband", draw_deadband}};
  return kEntries;
}

}  // namespace zerorate::campaign

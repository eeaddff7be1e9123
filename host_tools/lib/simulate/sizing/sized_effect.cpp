#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <tuple>
#include <utility>

namespace zerorate::sizing {

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

namespace {

/// An effect of a recording with the numbers that its other parameters are drawn from.
struct Candidate {
  EffectEntry entry;
  Draws draws;
  double size = 0.0;  ///< 0: not known yet

  [[nodiscard]] SizedEffect in(const RecordingSetting& setting) const {
    Draws again = draws;
    return entry.draw(setting, again);
  }
};

/// The setting, to those who know that the effect is there.
RecordingSetting with(RecordingSetting setting, const SizedEffect& effect, double size) {
  simulate::Signal slow(setting.samples, setting.period_s);
  slow.temperature_degc = setting.temperature_degc;
  slow.rate_rad_s = std::move(setting.slow_rad_s);
  if (effect.replaces_flicker) {
    const std::vector<double> flicker = alone(setting, flicker_noise_of(setting));
    for (std::size_t k = 0; k < flicker.size(); ++k) slow.rate_rad_s[k] -= flicker[k];
  }
  effect.at(size)(slow);
  setting.slow_rad_s = std::move(slow.rate_rad_s);
  setting.noise = effect.noise_with(setting.noise, size);
  return setting;
}

/// Sizes each effect beside the others in turn until the sizes stand still; false if they do not.
bool settle(std::vector<Candidate>& candidates, const RecordingSetting& setting, double nats) {
  constexpr int kMostRounds = 12;
  constexpr double kStill = 0.01;  // a few hundredths of what is asked for
  for (int round = 0; round < kMostRounds; ++round) {
    double most_change = 0.0;
    for (Candidate& one : candidates) {
      RecordingSetting beside = setting;
      for (const Candidate& other : candidates) {
        if (&other == &one || other.size == 0.0) continue;
        beside = with(std::move(beside), other.in(setting), other.size);
      }
      const std::optional<double> size = size_for(one.in(beside), nats);
      if (!size) return false;
      most_change = std::max(most_change, std::abs(*size / one.size - 1.0));
      one.size = *size;
    }
    if (candidates.size() == 1 || most_change < kStill) return true;
  }
  return false;
}

}  // namespace

std::optional<std::vector<HiddenEffect>> size_together(std::span<const EffectEntry> entries,
                                                       const RecordingSetting& setting, double nats,
                                                       Draws& draws) {
  std::vector<Candidate> candidates;
  for (const EffectEntry& entry : entries) {
    candidates.push_back({entry, draws});
    std::ignore = entry.draw(setting, draws);
  }
  if (!settle(candidates, setting, nats)) return std::nullopt;
  std::vector<HiddenEffect> hidden;
  for (const Candidate& one : candidates) {
    const SizedEffect effect = one.in(setting);
    hidden.push_back({effect.name, effect.at(one.size), one.size, effect.replaces_flicker,
                      effect.figures(one.size)});
  }
  return hidden;
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

}  // namespace zerorate::sizing

// Effects that come as events at random times. Who knows the truth does not know the times: the
// likelihood of the truth is a sum over all paths, of which one term, the path that was realised,
// is a lower bound.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

namespace zerorate::sizing {
namespace {

using simulate::Effect;

/// The events of one recording at unit size.
struct Events {
  std::vector<double> contrasts;
  std::vector<double> squared_norms;  ///< for each event, twice the gain of knowing it
  double expected_norm = 0.0;         ///< norm of an event of unit amplitude
  double price_nats = 0.0;            ///< price of beginning at one moment, per event
  double silence_nats = 0.0;          ///< price of beginning at none of the others
};

/// Energies of what stands between zeros.
std::vector<double> energies_of_events(const std::vector<double>& mean) {
  std::vector<double> energies;
  bool inside = false;
  for (const double rate : mean) {
    if (rate != 0.0 && !inside) energies.push_back(0.0);
    inside = rate != 0.0;
    if (inside) energies.back() += rate * rate;
  }
  return energies;
}

/// @param shape        of an event of unit amplitude
/// @param probability  that one begins at a sample
Events find_events(const RecordingSetting& setting, const std::vector<double>& mean,
                   const std::vector<double>& shape, double probability) {
  std::vector<double> one(setting.samples, 0.0);
  std::ranges::copy(shape, one.begin() + static_cast<std::ptrdiff_t>(setting.samples / 2));
  double shape_energy = 0.0;
  for (const double rate : shape) shape_energy += rate * rate;
  Events events{.contrasts = contrasts(mean),
                .squared_norms = energies_of_events(mean),
                .expected_norm = setting.noise.squared_norm(contrasts(one)),
                .price_nats = -std::log(probability),
                .silence_nats = -static_cast<double>(setting.samples) * std::log1p(-probability)};
  for (double& energy : events.squared_norms) energy *= events.expected_norm / shape_energy;
  return events;
}

/// Gain of the path over the base noise: for an event of normal amplitude, whose variance is
/// size^2, with the amplitude integrated out, the expected log likelihood ratio at the amplitude
/// that was realised; less the price of its moment. Events that are not worth it stay out.
double path_gain_nats(const Events& events, double size) {
  const double signal_to_noise = size * size * events.expected_norm;
  const double shrink = signal_to_noise / (1.0 + signal_to_noise);
  double sum = -events.silence_nats;
  for (const double norm : events.squared_norms) {
    const double gain = 0.5 * (size * size * norm + 1.0) * shrink -
                        0.5 * std::log1p(signal_to_noise) - events.price_nats;
    sum += std::max(0.0, gain);
  }
  return sum;
}

SizedEffect random_events(const RecordingSetting& setting, std::string_view name, Events events,
                          std::function<Effect(double)> effect) {
  const double most = std::sqrt(std::ranges::max(events.squared_norms));
  const auto shared = std::make_shared<Events>(std::move(events));
  return {.name = std::string(name),
          .at = [&setting, effect](double size) { return part_of(setting, effect(size)); },
          .loss_nats =
              [&setting, shared](double size) {
                std::vector<double> scaled = shared->contrasts;
                for (double& contrast : scaled) contrast *= size;
                // Without the events the truth's noise pays for all their energy.
                const double unexplained = 0.5 * setting.noise.squared_norm(scaled);
                return setting.noise.loss_to_mean(scaled) - unexplained +
                       path_gain_nats(*shared, size);
              },
          .guess = 6.0 / most};
}

/// Prior cost of the times at which a two-level path switches.
double path_price_nats(const std::vector<double>& level, double up_per_sample,
                       double down_per_sample) {
  double price = 0.0;
  for (std::size_t k = 1; k < level.size(); ++k) {
    const double p = level[k - 1] == 0.0 ? up_per_sample : down_per_sample;
    price -= level[k] == level[k - 1] ? std::log1p(-p) : std::log(p);
  }
  return price;
}

}  // namespace

SizedEffect draw_random_telegraph_noise(const RecordingSetting& setting, Draws& draws) {
  const double mean_s = setting.record_s() / draws.log_uniform(8.0, 60.0);
  const double asymmetry = draws.log_uniform(0.5, 2.0);
  const double low_s = mean_s * asymmetry;
  const double high_s = mean_s / asymmetry;
  const double effect_sign = draws.sign();
  const auto effect = [=](double height) -> Effect {
    return simulate::RandomTelegraphNoise{effect_sign * height, low_s, high_s};
  };
  const std::vector<double> level = alone(setting, part_of(setting, effect(1.0)));
  const double price = path_price_nats(level, setting.period_s / low_s, setting.period_s / high_s);
  const auto unit = std::make_shared<std::vector<double>>(contrasts(level));
  return {.name = "random_telegraph_noise",
          .at = [&setting, effect](double height) { return part_of(setting, effect(height)); },
          .loss_nats =
              [&setting, unit, price](double height) {
                std::vector<double> scaled = *unit;
                for (double& contrast : scaled) contrast *= height;
                return setting.noise.loss_to_mean(scaled) - price;
              },
          .noise_with = [unit](const BaseNoise& noise, double) { return noise.beside_mean(*unit); },
          .guess = 20.0 / std::sqrt(setting.noise.squared_norm(*unit) + 1e-300),
          .figures = [=, is_up = effect_sign > 0.0](double height) -> Figures {
            return {{"height_dps", height * kDegPerRad},
                    {"mean_low_s", is_up ? low_s : high_s},
                    {"mean_high_s", is_up ? high_s : low_s}};
          }};
}

SizedEffect draw_outliers(const RecordingSetting& setting, Draws& draws) {
  const double probability = draws.log_uniform(6.0, 60.0) / static_cast<double>(setting.samples);
  const auto effect = [probability](double sigma) -> Effect {
    return simulate::Outliers{sigma, probability};
  };
  const std::vector<double> mean = alone(setting, part_of(setting, effect(1.0)));
  SizedEffect outliers =
      random_events(setting, "outliers", find_events(setting, mean, {1.0}, probability), effect);
  outliers.figures = [probability](double sigma) -> Figures {
    return {{"probability", probability}, {"sigma_dps", sigma * kDegPerRad}};
  };
  return outliers;
}

SizedEffect draw_motion_contamination(const RecordingSetting& setting, Draws& draws) {
  const double samples = draws.log_uniform(5.0, 100.0);
  const double interval_s = setting.record_s() / draws.log_uniform(5.0, 25.0);
  std::vector<double> shape;
  for (double share = 0.5 / samples; share < 1.0; share += 1.0 / samples) {
    shape.push_back(std::sin(std::numbers::pi * share));
  }
  const auto effect = [=, duration_s = samples * setting.period_s](double sigma) -> Effect {
    return simulate::MotionContamination{sigma, interval_s, duration_s};
  };
  const std::vector<double> mean = alone(setting, part_of(setting, effect(1.0)));
  SizedEffect motion =
      random_events(setting, "motion_contamination",
                    find_events(setting, mean, shape, setting.period_s / interval_s), effect);
  motion.figures = [duration_s = samples * setting.period_s](double sigma) -> Figures {
    return {{"peak_sigma_dps", sigma * kDegPerRad}, {"duration_s", duration_s}};
  };
  return motion;
}

}  // namespace zerorate::sizing

// Effects that change the spectrum or the mean.

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "host_tools/lib/campaign/sized_effect.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"

namespace zerorate::campaign {
namespace {

using simulate::Effect;

/// Noise whose spectrum is added to that of the base.
SizedEffect added_noise(const RecordingSetting& setting, std::string_view name,
                        Spectrum unit_spectrum, std::function<Effect(double)> effect,
                        std::function<Figures(double)> figures) {
  return {.name = std::string(name),
          .at = [&setting, effect](double size) { return part_of(setting, effect(size)); },
          .loss_nats =
              [&setting, unit = std::move(unit_spectrum)](double size) {
                Spectrum truth = setting.noise.spectrum();
                for (std::size_t k = 0; k < truth.size(); ++k) truth[k] += size * size * unit[k];
                return setting.noise.loss_to_spectrum(truth);
              },
          .guess = 0.1 * setting.noise.white_sigma(),
          .figures = std::move(figures)};
}

/// A mean function in proportion to the size.
SizedEffect added_mean(const RecordingSetting& setting, std::string_view name,
                       std::function<Effect(double)> effect,
                       std::function<Figures(double)> figures) {
  const auto unit = std::make_shared<std::vector<double>>(
      contrasts(alone(setting, part_of(setting, effect(1.0)))));
  return {.name = std::string(name),
          .at = [&setting, effect](double size) { return part_of(setting, effect(size)); },
          .loss_nats =
              [&setting, unit](double size) {
                std::vector<double> scaled = *unit;
                for (double& contrast : scaled) contrast *= size;
                return setting.noise.loss_to_mean(scaled);
              },
          .guess = 10.0 / std::sqrt(setting.noise.squared_norm(*unit)),
          .figures = std::move(figures)};
}

}  // namespace

SizedEffect draw_rate_random_walk(const RecordingSetting& setting, Draws& /*draws*/) {
  const double root_period = std::sqrt(setting.period_s);
  SizedEffect walk = added_noise(
      setting, "rate_random_walk", fractional_spectrum(setting.noise.samples(), 1.0),
      [root_period](double step) -> Effect { return simulate::RateRandomWalk{step / root_period}; },
      [root_period](double step) -> Figures {
        return {{"coefficient_dps_per_sqrt_s", step / root_period * kDegPerRad}};
      });
  walk.guess = 0.01 * setting.noise.white_sigma();
  return walk;
}

SizedEffect draw_correlated_noise(const RecordingSetting& setting, Draws& draws) {
  const double most = static_cast<double>(setting.samples) / 40.0;
  const double time_constant = draws.log_uniform(2.0, most);  // samples
  const double time_constant_s = time_constant * setting.period_s;
  return added_noise(
      setting, "correlated_noise", gauss_markov_spectrum(setting.noise.samples(), time_constant),
      [time_constant_s](double sigma) -> Effect {
        return simulate::CorrelatedNoise{sigma, time_constant_s};
      },
      [time_constant_s](double sigma) -> Figures {
        return {{"sigma_dps", sigma * kDegPerRad}, {"time_constant_s", time_constant_s}};
      });
}

SizedEffect draw_fractional_order(const RecordingSetting& setting, Draws& draws) {
  const double order =
      draws.with_probability(0.75) ? draws.uniform(0.65, 0.95) : draws.uniform(0.2, 0.35);
  const double white_variance = setting.noise.white_sigma() * setting.noise.white_sigma();
  return {.name = "fractional_order",
          .at =
              [&setting, order](double sigma) {
                return part_of(
                    setting,
                    simulate::FlickerNoise{
                        spectrum::bias_instability(sigma * sigma, order, setting.period_s), order});
              },
          .loss_nats =
              [&setting, white_variance,
               unit = fractional_spectrum(setting.noise.samples(), order)](double sigma) {
                Spectrum truth(unit.size());
                for (std::size_t k = 0; k < truth.size(); ++k) {
                  truth[k] = white_variance + sigma * sigma * unit[k];
                }
                return setting.noise.loss_to_spectrum(truth);
              },
          .guess = setting.flicker_sigma_rad_s,
          .replaces_flicker = true,
          .figures = [order](double) -> Figures {
            return {{"order", order}};
          }};
}

SizedEffect draw_sensor_bandwidth(const RecordingSetting& setting, Draws& /*draws*/) {
  // The size is the time constant in samples.
  const auto share = [](double time_constant) { return -std::expm1(-1.0 / time_constant); };
  return {.name = "sensor_bandwidth",
          .at =
              [&setting](double time_constant) {
                const double cut_off_hz =
                    setting.rate_hz() / (2.0 * std::numbers::pi * time_constant);
                return part_of(setting, simulate::SensorBandwidth{cut_off_hz});
              },
          .loss_nats =
              [&setting, share](double time_constant) {
                Spectrum truth = low_pass_gain(setting.noise.samples(), share(time_constant));
                for (std::size_t k = 0; k < truth.size(); ++k) {
                  truth[k] *= setting.noise.spectrum()[k];
                }
                return setting.noise.loss_to_spectrum(truth);
              },
          .guess = 0.3,
          .figures = [rate_hz = setting.rate_hz()](double time_constant) -> Figures {
            return {{"cut_off_hz", rate_hz / (2.0 * std::numbers::pi * time_constant)}};
          }};
}

SizedEffect draw_temperature_drift(const RecordingSetting& setting, Draws& draws) {
  const double sign = draws.sign();
  const bool curved = draws.with_probability(0.25);
  const double lag_s =
      draws.with_probability(0.25) ? setting.record_s() * draws.log_uniform(0.01, 0.1) : 0.0;
  const double reference_degc = draws.uniform(20.0, 30.0);
  // Curvature makes about half of a curved drift.
  const double quadratic = curved ? sign * draws.sign() * 0.1 : 0.0;
  return added_mean(
      setting, "temperature_drift",
      [=](double slope) -> Effect {
        return simulate::TemperatureDrift{.linear_rad_s_per_k = sign * slope,
                                          .quadratic_rad_s_per_k2 = quadratic * slope,
                                          .reference_degc = reference_degc,
                                          .lag_s = lag_s};
      },
      [sign, curved](double slope) -> Figures {
        // The slope of a curved one depends on the temperature that it is told at.
        if (curved) return {};
        return {{"linear_dps_per_k", sign * slope * kDegPerRad}};
      });
}

SizedEffect draw_temperature_rate(const RecordingSetting& setting, Draws& draws) {
  const double sign = draws.sign();
  const double lag_s = setting.record_s() * draws.log_uniform(0.003, 0.03);
  return added_mean(
      setting, "temperature_rate",
      [=](double coefficient) -> Effect {
        return simulate::TemperatureRate{.coefficient_rad_per_k = sign * coefficient,
                                         .lag_s = lag_s};
      },
      [sign](double coefficient) -> Figures {
        return {{"coefficient_deg_per_k", sign * coefficient * kDegPerRad}};
      });
}

SizedEffect draw_warm_up_transient(const RecordingSetting& setting, Draws& draws) {
  const double sign = draws.sign();
  const double time_constant_s = setting.record_s() * draws.log_uniform(0.02, 0.25);
  return added_mean(
      setting, "warm_up_transient",
      [=](double amplitude) -> Effect {
        return simulate::WarmUpTransient{sign * amplitude, time_constant_s};
      },
      [=](double amplitude) -> Figures {
        return {{"amplitude_dps", sign * amplitude * kDegPerRad},
                {"time_constant_s", time_constant_s}};
      });
}

SizedEffect draw_rate_ramp(const RecordingSetting& setting, Draws& draws) {
  const double slope = draws.sign() / setting.record_s();
  return added_mean(
      setting, "rate_ramp", [=](double rise) -> Effect { return simulate::RateRamp{slope * rise}; },
      [slope](double rise) -> Figures {
        return {{"slope_dps_per_s", slope * rise * kDegPerRad}};
      });
}

SizedEffect draw_periodic_disturbance(const RecordingSetting& setting, Draws& draws) {
  const double cycles = draws.log_uniform(15.0, 0.45 * static_cast<double>(setting.samples));
  const double frequency_hz = cycles / setting.record_s();
  const double phase_rad = draws.uniform(0.0, 2.0 * std::numbers::pi);
  return added_mean(
      setting, "periodic_disturbance",
      [=](double amplitude) -> Effect {
        return simulate::PeriodicDisturbance{amplitude, frequency_hz, phase_rad};
      },
      [frequency_hz](double amplitude) -> Figures {
        return {{"amplitude_dps", amplitude * kDegPerRad}, {"frequency_hz", frequency_hz}};
      });
}

SizedEffect draw_bias_jump(const RecordingSetting& setting, Draws& draws) {
  const double sign = draws.sign();
  const double time_s = setting.record_s() * draws.uniform(0.08, 0.92);
  return added_mean(
      setting, "bias_jump",
      [=](double height) -> Effect {
        return simulate::BiasJump{sign * height, time_s};
      },
      [=](double height) -> Figures {
        return {{"height_dps", sign * height * kDegPerRad}, {"time_s", time_s}};
      });
}

SizedEffect draw_relaxation(const RecordingSetting& setting, Draws& draws) {
  const double time_constant_s = setting.record_s() * draws.log_uniform(0.01, 0.1);
  const int jumps = draws.with_probability(0.5) ? 3 : 2;
  std::vector<simulate::Relaxation::Jump> of_unit_size;
  for (int i = 0; i < jumps; ++i) {
    // Each in a part of the record of its own. The largest is at most 1.5 times the smallest, so
    // that each can pay for its own place.
    const double share = (i + draws.uniform(0.1, 0.9)) / jumps;
    const double sign = draws.sign();
    const double height = sign * draws.log_uniform(1.0, 1.5);
    of_unit_size.push_back({setting.record_s() * (0.05 + 0.9 * share), height});
  }
  SizedEffect all = added_mean(
      setting, "relaxation",
      [=](double height) -> Effect {
        simulate::Relaxation relaxation{of_unit_size, time_constant_s};
        for (auto& jump : relaxation.jumps) jump.height_rad_s *= height;
        return relaxation;
      },
      [time_constant_s](double) -> Figures {
        return {{"time_constant_s", time_constant_s}};
      });
  // Two places of a jump are told apart where they lie a time constant apart.
  const double price = jumps * std::log(setting.record_s() / time_constant_s);
  all.loss_nats = [of_means = all.loss_nats, price](double height) {
    return of_means(height) - price;
  };
  return all;
}

}  // namespace zerorate::campaign

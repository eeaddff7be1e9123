// Effects that change the spectrum or the mean.

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "host_tools/lib/simulate/sizing/sized_effect.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"

namespace zerorate::sizing {
namespace {

using simulate::Effect;

/// Another spectrum of the noise.
SizedEffect other_noise(const RecordingSetting& setting, std::string_view name,
                        std::function<Effect(double)> effect,
                        std::function<BaseNoise(const BaseNoise&, double)> noise_with) {
  return {.name = std::string(name),
          .at = [&setting, effect](double size) { return part_of(setting, effect(size)); },
          .loss_nats =
              [&setting, noise_with](double size) {
                return setting.noise.loss_to_spectrum(noise_with(setting.noise, size).spectrum());
              },
          .noise_with = noise_with};
}

/// Shape of a noise, and neighbours of it.
using Shapes = std::array<Spectrum, 3>;

/// The noise to those who know the effect, but not its time constant or order: they may take the
/// neighbours in the place of its shape.
BaseNoise or_near(const BaseNoise& noise, const Shapes& shapes) {
  return noise.with_noise(shapes[1], 0.0).with_noise(shapes[2], 0.0);
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
          .noise_with = [unit](const BaseNoise& noise, double) { return noise.beside_mean(*unit); },
          .guess = 10.0 / std::sqrt(setting.noise.squared_norm(*unit)),
          .figures = std::move(figures)};
}

}  // namespace

SizedEffect draw_rate_random_walk(const RecordingSetting& setting, Draws& /*draws*/) {
  const double root_period = std::sqrt(setting.period_s);
  SizedEffect walk = other_noise(
      setting, "rate_random_walk",
      [root_period](double step) -> Effect { return simulate::RateRandomWalk{step / root_period}; },
      [unit = fractional_spectrum(setting.noise.samples(), 1.0)](
          const BaseNoise& noise, double step) { return noise.with_noise(unit, step * step); });
  walk.guess = 0.01 * setting.noise.white_sigma();
  walk.figures = [root_period](double step) -> Figures {
    return {{"coefficient_dps_per_sqrt_s", step / root_period * kDegPerRad}};
  };
  return walk;
}

SizedEffect draw_correlated_noise(const RecordingSetting& setting, Draws& draws) {
  const double most = static_cast<double>(setting.samples) / 40.0;
  const double time_constant = draws.log_uniform(2.0, most);  // samples
  const double time_constant_s = time_constant * setting.period_s;
  const auto unit = [n = setting.noise.samples(), time_constant](double factor) {
    return gauss_markov_spectrum(n, factor * time_constant);
  };
  SizedEffect markov = other_noise(
      setting, "correlated_noise",
      [time_constant_s](double sigma) -> Effect {
        return simulate::CorrelatedNoise{sigma, time_constant_s};
      },
      [shapes = Shapes{unit(1.0), unit(0.5), unit(2.0)}](const BaseNoise& noise, double sigma) {
        return or_near(noise.with_noise(shapes[0], sigma * sigma), shapes);
      });
  markov.guess = 0.1 * setting.noise.white_sigma();
  markov.figures = [=](double sigma) -> Figures {
    return {{"sigma_dps", sigma * kDegPerRad}, {"time_constant_s", time_constant_s}};
  };
  return markov;
}

SizedEffect draw_fractional_order(const RecordingSetting& setting, Draws& draws) {
  const double order =
      draws.with_probability(0.75) ? draws.uniform(0.65, 0.95) : draws.uniform(0.2, 0.35);
  const auto unit = [n = setting.noise.samples(), order](double more) {
    return fractional_spectrum(n, order + more);
  };
  SizedEffect flicker = other_noise(
      setting, "fractional_order",
      [order, period_s = setting.period_s](double sigma) -> Effect {
        return simulate::FlickerNoise{spectrum::bias_instability(sigma * sigma, order, period_s),
                                      order};
      },
      [shapes = Shapes{unit(0.0), unit(-0.1), unit(0.1)}](const BaseNoise& noise, double sigma) {
        return or_near(noise.with_flicker_noise(shapes[0], sigma * sigma), shapes);
      });
  flicker.guess = setting.flicker_sigma_rad_s;
  flicker.replaces_flicker = true;
  flicker.figures = [order](double) -> Figures { return {{"order", order}}; };
  return flicker;
}

SizedEffect draw_sensor_bandwidth(const RecordingSetting& setting, Draws& /*draws*/) {
  // The size is the time constant in samples.
  const auto cut_off_hz = [rate_hz = setting.rate_hz()](double time_constant) {
    return rate_hz / (2.0 * std::numbers::pi * time_constant);
  };
  SizedEffect low_pass = other_noise(
      setting, "sensor_bandwidth",
      [cut_off_hz](double time_constant) -> Effect {
        return simulate::SensorBandwidth{cut_off_hz(time_constant)};
      },
      [](const BaseNoise& noise, double time_constant) {
        return noise.behind(low_pass_gain(noise.samples(), -std::expm1(-1.0 / time_constant)));
      });
  low_pass.guess = 0.3;
  low_pass.figures = [cut_off_hz](double time_constant) -> Figures {
    return {{"cut_off_hz", cut_off_hz(time_constant)}};
  };
  return low_pass;
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

}  // namespace zerorate::sizing

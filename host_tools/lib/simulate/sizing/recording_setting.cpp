#include "host_tools/lib/simulate/sizing/recording_setting.hpp"

#include <numbers>
#include <utility>
#include <variant>

#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::sizing {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// A few slow swings and a trend: neither a ramp nor an exponential nor a tone.
std::vector<double> draw_temperature(std::size_t samples, Draws& draws) {
  std::vector<double> temperature(samples, draws.uniform(15.0, 40.0));
  const double span_k = draws.log_uniform(2.0, 20.0);
  const double trend_k = span_k * draws.uniform(-1.0, 1.0);
  constexpr int kSwings = 3;
  for (int swing = 0; swing <= kSwings; ++swing) {
    const double cycles = draws.uniform(0.6, 3.0);
    const double phase = draws.uniform(0.0, 2.0 * std::numbers::pi);
    const double amplitude_k = span_k * draws.uniform(0.2, 0.5);
    for (std::size_t k = 0; k < samples; ++k) {
      const double share = static_cast<double>(k) / static_cast<double>(samples);
      temperature[k] +=
          swing == kSwings
              ? trend_k * share
              : amplitude_k * std::sin(2.0 * std::numbers::pi * cycles * share + phase);
    }
  }
  return temperature;
}

}  // namespace

Part part_of(const RecordingSetting& setting, const simulate::Effect& effect) {
  return [stream = setting.stream.substream(simulate::name(effect)),
          effect](simulate::Signal& signal) {
    std::visit([&](const auto& part) { part.apply(signal, stream); }, effect);
  };
}

Part white_noise_of(const RecordingSetting& setting) {
  const double variance = setting.noise.white_sigma() * setting.noise.white_sigma();
  return part_of(setting,
                 simulate::WhiteNoise{spectrum::angle_random_walk(variance, setting.period_s)});
}

Part flicker_noise_of(const RecordingSetting& setting) {
  return part_of(setting,
                 simulate::FlickerNoise{.bias_instability_rad_s = setting.flicker_sigma_rad_s});
}

std::vector<double> alone(const RecordingSetting& setting, const Part& part) {
  simulate::Signal signal(setting.samples, setting.period_s);
  signal.temperature_degc = setting.temperature_degc;
  part(signal);
  return std::move(signal.rate_rad_s);
}

RecordingSetting draw_setting(std::size_t samples, double rate_hz,
                              const random::RandomStream& stream) {
  Draws draws{stream.substream("setting")};
  const double drawn_hz = std::round(draws.log_uniform(1.0, 200.0));
  const double white_sigma = draws.log_uniform(0.005, 0.2) * kRadPerDeg;
  // The paper's sensor has 3.2; beyond about 50 a record of 20,000 samples does not show its 1/f.
  const double white_over_flicker = draws.log_uniform(2.5, 50.0);
  const double flicker_sigma = white_sigma / white_over_flicker;
  RecordingSetting setting{
      .samples = samples,
      .period_s = 1.0 / (rate_hz > 0.0 ? rate_hz : drawn_hz),
      .noise = BaseNoise(spectrum::fast_length_below(samples), white_sigma, flicker_sigma),
      .flicker_sigma_rad_s = flicker_sigma,
      .bias_rad_s = 0.5 * kRadPerDeg * draws.normal(),
      .temperature_degc = draw_temperature(samples, draws),
      .stream = stream};
  setting.slow_rad_s = alone(setting, flicker_noise_of(setting));
  for (double& rate : setting.slow_rad_s) rate += setting.bias_rad_s;
  return setting;
}

}  // namespace zerorate::sizing

#include "host_tools/lib/diagnose/selection/model_export.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

/// Weaker flicker noise than this share of the white noise at the lowest frequency is none.
constexpr double kNoFlicker = 1e-6;

}  // namespace

model::SensorModel model_of(const Hypothesis& hypothesis, std::span<const Choice> choices,
                            const std::string& source) {
  const NoiseSpectrum& noise = hypothesis.noise().spectrum;
  const double period_s = hypothesis.data().period_s();
  model::SensorModel model;
  model.name = source;
  const double white_variance = noise.white_variance + noise.rounding_variance;
  model.white = {spectrum::angle_random_walk(white_variance, period_s), "diagnosed from " + source};
  const double lowest = hypothesis.data().sines()[1];
  if (noise.flicker_variance * std::pow(lowest, -2.0 * noise.flicker_order) >
      kNoFlicker * noise.white_variance) {
    model.flicker = model::Flicker{.bias_instability_rad_s = spectrum::bias_instability(
                                       noise.flicker_variance, noise.flicker_order, period_s),
                                   .order = noise.flicker_order,
                                   .shortest_time_constant_s = std::max(0.5, 0.5 * period_s),
                                   .source = "diagnosed from " + source};
  }
  for (std::size_t i = 0; i < choices.size(); ++i) {
    choices[i].effect->add_to_model({hypothesis, i}, model);
  }
  return model;
}

namespace {

NoiseSpectrum markov_spectrum(double sigma_rad_s, double time_constant_samples) {
  return {.markov_variance = sigma_rad_s * sigma_rad_s, .markov_samples = time_constant_samples};
}

/// White noise, flicker noise and random walk.
NoiseSpectrum main_spectrum(const model::SensorModel& model, double period_s) {
  NoiseSpectrum noise{.white_variance = spectrum::white_variance(
                          model.white.angle_random_walk_rad_per_sqrt_s, period_s)};
  if (model.quantization) {
    noise.white_variance += model.quantization->step_rad_s * model.quantization->step_rad_s / 12.0;
  }
  if (model.flicker) {
    noise.flicker_order = model.flicker->order;
    noise.flicker_variance = spectrum::flicker_innovation_variance(
        model.flicker->bias_instability_rad_s, noise.flicker_order, period_s);
  }
  if (model.rate_random_walk) {
    const double coefficient = model.rate_random_walk->coefficient_rad_s_per_sqrt_s;
    noise.walk_variance = coefficient * coefficient * period_s;
  }
  return noise;
}

NoiseSpectrum line_spectrum(const model::Harmonic& line, double period_s) {
  return {.line_variance = line.rms_rad_s * line.rms_rad_s,
          .line_angle = 2.0 * std::numbers::pi * line.frequency_hz * period_s,
          .line_samples = line.coherence_time_s / period_s};
}

std::vector<double> density_of(const FitData& data, const model::SensorModel& model) {
  const std::size_t n = data.size();
  std::vector<NoiseSpectrum> parts{main_spectrum(model, data.period_s())};
  for (const model::GaussMarkov& process : model.gauss_markov) {
    parts.push_back(
        markov_spectrum(process.sigma_rad_s, process.time_constant_s / data.period_s()));
  }
  for (const model::Harmonic& line : model.harmonic) {
    parts.push_back(line_spectrum(line, data.period_s()));
  }
  std::vector<double> density(n);
  for (std::size_t k = 1; k < n; ++k) {
    for (const NoiseSpectrum& part : parts) density[k] += part.density(data.sines()[k], k, n);
  }
  return density;
}

/// Deviation of the sensing element from the model's reference; none without a thermometer.
std::vector<double> element_temperature(const FitData& data, const model::TemperatureDrift& drift) {
  const std::vector<double>& measured = data.series().temperature_degc;
  if (measured.empty()) return {};
  const double follow = drift.lag_s > 0.0 ? -std::expm1(-data.period_s() / drift.lag_s) : 1.0;
  std::vector<double> excess(data.size());
  double element = measured.front();
  for (std::size_t k = 0; k < excess.size(); ++k) {
    element += follow * (measured[k] - element);
    excess[k] = element - drift.reference_degc;
  }
  return excess;
}

/// Mean functions that the node learns anew at each start.
Part learned_part(const FitData& data, const model::SensorModel& model) {
  Part part{.effect = "given_model"};
  if (model.warm_up) {
    part.columns.push_back(decay_column(data, model.warm_up->time_constant_s));
  }
  if (model.rate_ramp)
    part.columns.push_back(column_of(data, [](double time_s) { return time_s; }));
  if (!model.temperature) return part;
  std::vector<double> excess = element_temperature(data, *model.temperature);
  if (excess.empty()) return part;
  part.columns.push_back(column_of(data, std::span<const double>(excess)));
  const bool is_curved = model.temperature->curvature_rad_s_per_k2 != 0.0 ||
                         model.temperature->curvature_sigma_rad_s_per_k2 > 0.0;
  if (!is_curved) return part;
  for (double& value : excess) value *= value;
  part.columns.push_back(column_of(data, std::span<const double>(excess)));
  return part;
}

}  // namespace

Hypothesis hypothesis_of(const FitData& data, const model::SensorModel& model) {
  std::vector<Part> parts;
  Part learned = learned_part(data, model);
  if (!learned.columns.empty()) parts.push_back(std::move(learned));
  return {data, std::move(parts), density_of(data, model)};
}

Hypothesis base_beside_fast_effects(const Hypothesis& base, const Hypothesis& full) {
  const auto is_fast = [](const Part& part) {
    return part.columns.empty() && (part.terms.low_pass || part.terms.line);
  };
  std::vector<Part> fast;
  std::ranges::copy_if(full.parts(), std::back_inserter(fast), is_fast);
  if (fast.empty()) return base;
  const FitData& data = base.data();
  const NoiseSpectrum fitted = Hypothesis(data, std::move(fast), &full).noise().spectrum;
  const NoiseSpectrum noise{.white_variance = fitted.white_variance + fitted.rounding_variance,
                            .flicker_variance = fitted.flicker_variance,
                            .flicker_order = fitted.flicker_order};
  std::vector<double> density(data.size());
  for (std::size_t k = 1; k < density.size(); ++k) {
    density[k] = noise.density(data.sines()[k], k, density.size());
  }
  return {data, {}, std::move(density)};
}

bool is_enough(const Hypothesis& given, const model::SensorModel& model, const Hypothesis& fitted) {
  constexpr double kParametersOfEffect = 3.0;  // at most
  double parameters = 2.0;                     // the strengths of white and flicker noise
  for (const Part& part : fitted.parts()) {
    const bool is_rounding = part.effect == "quantization" && model.quantization;
    const bool is_fitted = !part.columns.empty() || part.terms != NoiseTerms{};
    if (!is_rounding && !is_fitted) return false;
    parameters += kParametersOfEffect;
  }
  const double gain =
      fitted.log_likelihood_of_coefficients() - given.log_likelihood_of_coefficients();
  return -statistics::log_chi_squared_tail(2.0 * gain, parameters) < kSelectionThreshold_nats;
}

}  // namespace zerorate::diagnose

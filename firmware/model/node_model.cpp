#include "firmware/model/node_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/base/numeric.hpp"
#include "core/noise/terms.hpp"
#include "core/samples/rounding_watch.hpp"
#include "firmware/model/flicker_fit.hpp"
#include "firmware/model/model_fields.hpp"
#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {
namespace {

using Decades = core::FlickerDecades<kMostDecades>;

double seconds(core::Duration duration) {
  return static_cast<double>(duration.ns()) * 1e-9;
}

/// A positive number below single precision's smallest normal one would lose its digits, one above
/// its greatest its value.
float single(double value) {
  const auto rounded = static_cast<float>(value);
  if (value != 0.0 && !std::isnormal(rounded)) {
    throw std::invalid_argument("a coefficient of the model is beyond single precision");
  }
  return rounded;
}

/// Zero for a value below single precision's smallest normal number.
float single_or_zero(double value) {
  return std::isnormal(static_cast<float>(value)) ? static_cast<float>(value) : 0.0F;
}

Decades decades_of(const FlickerFit& fit) {
  Decades decades;
  decades.time_constant_s.fill(1.0F);
  for (std::size_t i = 0; i < fit.time_constants_s.size(); ++i) {
    decades.time_constant_s[i] = single(fit.time_constants_s[i]);
    decades.variance_rad2_s2[i] = single(fit.variances_rad2_s2[i]);
  }
  return decades;
}

/// Squares of single-precision numbers may still overflow.
void require_finite(const core::ModesOf<kWidestLearningShape>& modes) {
  bool finite = core::is_finite(modes.walk_variance);
  for (const auto& mode : modes.decaying) {
    finite = finite && core::is_finite(mode.noise_variance) &&
             core::is_finite(mode.initial_variance) && core::is_finite(mode.initial_mean);
  }
  for (const auto& mode : modes.rotating) {
    finite = finite && core::is_finite(mode.noise_variance);
  }
  if (!finite) {
    throw std::invalid_argument("a variance of the model is beyond single precision");
  }
}

core::RandomWalk random_walk_of(const RateRandomWalk& walk) {
  return {.coefficient_rad_s_sqrt_s = single(walk.coefficient_rad_s_per_sqrt_s)};
}

core::GaussMarkov block_of(const GaussMarkov& process) {
  return {.sigma_rad_s = single(process.sigma_rad_s),
          .time_constant_s = single(process.time_constant_s)};
}

core::Harmonic block_of(const Harmonic& line) {
  return {.rms_rad_s = single(line.rms_rad_s),
          .frequency_hz = single(line.frequency_hz),
          .coherence_time_s = single(line.coherence_time_s)};
}

/// The blocks of all parts, the rest without noise.
template <class Block, std::size_t N, class Part>
std::array<Block, N> blocks_of(std::span<const Part> parts, std::string_view table) {
  if (parts.size() > N) {
    throw std::invalid_argument("the model has " + std::to_string(parts.size()) + " tables [[" +
                                std::string(table) + "]]; a node takes " + std::to_string(N));
  }
  std::array<Block, N> blocks;
  std::transform(parts.begin(), parts.end(), blocks.begin(),
                 [](const Part& part) { return block_of(part); });
  return blocks;
}

core::TemperatureDrift temperature_of(const TemperatureDrift& drift) {
  return {.reference_degc = single(drift.reference_degc),
          .slope_rad_s_per_k = single(drift.slope_rad_s_per_k),
          .slope_sigma_rad_s_per_k = single(drift.slope_sigma_rad_s_per_k),
          .curvature_rad_s_per_k2 = single(drift.curvature_rad_s_per_k2),
          .curvature_sigma_rad_s_per_k2 = single(drift.curvature_sigma_rad_s_per_k2),
          .lag_s = single(drift.lag_s)};
}

/// Inputs of the filter that a table stands for.
std::vector<core::Input> inputs_of(InputQuantity quantity) {
  switch (quantity) {
    case InputQuantity::acceleration:
      return {core::Input::acceleration_x, core::Input::acceleration_y,
              core::Input::acceleration_z};
    case InputQuantity::acceleration_x:
      return {core::Input::acceleration_x};
    case InputQuantity::acceleration_y:
      return {core::Input::acceleration_y};
    case InputQuantity::acceleration_z:
      return {core::Input::acceleration_z};
    case InputQuantity::vibration:
      return {core::Input::vibration};
    case InputQuantity::temperature_rate:
      return {core::Input::temperature_rate};
  }
  return {};
}

std::array<float, 3> single(const std::array<double, 3>& values) {
  return {single_or_zero(values[0]), single_or_zero(values[1]), single_or_zero(values[2])};
}

core::InputTerms<kWidestShape.inputs> inputs_of(const SensorModel& model) {
  core::InputTerms<kWidestShape.inputs> inputs;
  std::size_t used = 0;
  if (model.temperature) {
    temperature_of(*model.temperature).put_into(inputs);
    used = core::TemperatureDrift::kTerms;
  }
  for (const Input& given : model.inputs) {
    const auto name = std::string{kInputQuantities.at(static_cast<std::size_t>(given.quantity))};
    const auto coefficient = single(given.coefficient_rad_s_per_unit);
    if (given.quantity == InputQuantity::acceleration && coefficient != std::array<float, 3>{}) {
      throw std::invalid_argument(
          "[[input]] of \"acceleration\" has a coefficient_dps_per_unit: give acceleration_x, "
          "acceleration_y and acceleration_z a table each");
    }
    const bool is_ignored = given.without_accelerometer == WithoutAccelerometer::ignore;
    if (is_ignored && given.quantity == InputQuantity::temperature_rate) {
      throw std::invalid_argument(
          "[[input]] of \"temperature_rate\" has without_accelerometer = \"ignore\": a "
          "temperature needs no accelerometer; leave the key away");
    }
    for (const core::Input input : inputs_of(given.quantity)) {
      const auto is_there = [&](const core::InputTerm& term) { return term.input == input; };
      if (std::ranges::any_of(inputs.terms, is_there)) {
        throw std::invalid_argument("two tables [[input]] have the quantity \"" + name + "\"");
      }
      inputs.terms.at(used++) = {input, single_or_zero(given.sigma_rad_s_per_unit), coefficient};
    }
  }
  return inputs;
}

core::WarmUp warm_up_of(const WarmUp& transient) {
  return {.amplitude_rad_s = single(transient.amplitude_rad_s),
          .sigma_rad_s = single(transient.amplitude_sigma_rad_s),
          .time_constant_s = single(transient.time_constant_s)};
}

core::RateRamp rate_ramp_of(const RateRamp& ramp) {
  return {.slope_rad_s2 = single(ramp.slope_rad_s2),
          .sigma_rad_s2 = single(ramp.slope_sigma_rad_s2)};
}

core::Gate gate_of(const Gate& gate, double tick_s) {
  const double ticks = std::ceil(gate.longest_knock_s / tick_s);
  return {.threshold_sigma = single(gate.threshold_sigma),
          .longest_knock_ticks = static_cast<std::uint16_t>(
              std::min(ticks, double{std::numeric_limits<std::uint16_t>::max()}))};
}

float squared(double value) {
  return single(value * value);
}

core::MotionEvents motion_of(const MotionContamination& motion, double sample_s) {
  return {.begin_probability = single(std::min(0.5, sample_s / motion.interval_s)),
          .end_probability = single(std::min(1.0, sample_s / motion.duration_s)),
          .variance_rad2_s2 = squared(motion.sigma_rad_s)};
}

core::SampleModel samples_of(const SensorModel& model, double sample_s, double tick_s) {
  core::SampleModel samples;
  if (model.outliers) {
    samples.outliers = {.probability = single(model.outliers->probability),
                        .variance_rad2_s2 = squared(model.outliers->sigma_rad_s)};
  }
  if (model.motion_contamination) samples.motion = motion_of(*model.motion_contamination, sample_s);
  if (model.variable_noise) {
    samples.level = {
        .variance = squared(model.variable_noise->variance_sigma),
        .time_constants_per_tick = single(tick_s / model.variable_noise->time_constant_s)};
  }
  if (model.saturation) {
    samples.range = {.lower_rad_s = single(model.saturation->lower_rad_s),
                     .upper_rad_s = single(model.saturation->upper_rad_s)};
    if (!(samples.range.lower_rad_s < samples.range.upper_rad_s)) {
      throw std::invalid_argument("saturation.lower_dps must be less than saturation.upper_dps");
    }
  }
  return samples;
}

constexpr double kZeroCelsius_k = 273.15;

/// An axis that is askew measures the cosine of its tilt, as if its scale factor were smaller.
core::MotionModel motion_model_of(const SensorModel& model) {
  const ScaleFactor scale_factor = model.scale_factor.value_or(ScaleFactor{});
  const Mounting mounting = model.mounting.value_or(Mounting{});
  const double tilt = mounting.tilt_sigma_rad;
  return {.scale_factor = single(std::hypot(scale_factor.sigma, 1.0 - std::cos(tilt))),
          .asymmetry = single(scale_factor.asymmetry_sigma),
          .slope_variance_rad2 = single_or_zero(std::pow(tilt * mounting.slope_sigma, 2.0)),
          .scale_factor_per_k = single_or_zero(scale_factor.sigma_per_k),
          .scale_factor_at_k = single(scale_factor.reference_degc + kZeroCelsius_k)};
}

core::ScaleCorrection scale_correction_of(const SensorModel& model) {
  const ScaleFactor scale_factor = model.scale_factor.value_or(ScaleFactor{});
  core::ScaleCorrection scale;
  for (std::size_t i = 0; i < scale.factor.size(); ++i) {
    scale.factor[i] = core::ScaleCorrection::factor_of(single_or_zero(scale_factor.error[i]));
  }
  return scale;
}

/// Share of the strongest hypothesis that a lag has at least, so that there is something to
/// multiply where the model gives it no weight. The slowest lag of a strong walk has two million
/// times the variance of the model's.
constexpr double kTrace = 1e-7;

/// The hypotheses of a model beside the fit of its own flicker, whose lags without weight get a
/// trace.
core::Hypotheses<kWidestLearningShape> weigh_flickers(const SensorModel& model, double tick_s,
                                                      FlickerFit& own) {
  core::Hypotheses<kWidestLearningShape> weighed;
  const std::vector<FlickerHypothesis> guesses = hypotheses_of(model);
  std::vector<FlickerFit> fits;
  for (const FlickerHypothesis& guess : guesses) {
    fits.push_back(fit_flicker(guess.flicker, tick_s));
    for (std::size_t i = 0; i < own.variances_rad2_s2.size(); ++i) {
      own.variances_rad2_s2[i] =
          std::max(own.variances_rad2_s2[i], kTrace * fits.back().variances_rad2_s2[i]);
    }
  }
  const double arw = model.white.angle_random_walk_rad_per_sqrt_s;
  const double own_white = arw * arw / tick_s + own.white_variance_rad2_s2;
  for (std::size_t m = 0; m < guesses.size(); ++m) {
    // White noise at the tick, flicker or not, is the unit of a hypothesis.
    const double white = arw * arw / tick_s + fits[m].white_variance_rad2_s2;
    const double unit = own_white > 0.0 && white > 0.0 ? own_white / white : 1.0;
    core::NoiseHypothesis<kWidestShape.decaying>& one = weighed.all[m];
    one.strength.fill(1.0F);
    for (std::size_t i = 0; i < own.variances_rad2_s2.size(); ++i) {
      const double of_own = own.variances_rad2_s2[i];
      one.strength[i] =
          of_own > 0.0 ? single_or_zero(unit * fits[m].variances_rad2_s2[i] / of_own) : 0.0F;
    }
    one.log_prior = single(guesses[m].log_prior);
    one.level = single(unit * guesses[m].level);
    one.order = single(guesses[m].flicker.order);
    one.bias_instability_rad_s =
        single(std::sqrt(unit) * guesses[m].flicker.bias_instability_rad_s);
    one.angle_random_walk_rad_per_sqrt_s = single(std::sqrt(unit) * arw);
  }
  weighed.count = guesses.size();
  weighed.kept = single(std::exp2(-tick_s / model.learning.value_or(Learning{}).half_life_s));
  return weighed;
}

}  // namespace

SensorModel without_accelerometer(SensorModel model) {
  std::erase_if(model.inputs, [](const Input& input) {
    return input.without_accelerometer == WithoutAccelerometer::ignore;
  });
  return model;
}

bool fits_six_decades(const SensorModel& model) {
  return model.gauss_markov.empty() && model.harmonic.empty() && !model.warm_up &&
         !model.rate_ramp && !model.temperature && model.inputs.empty() &&
         (!model.flicker || model.flicker->decades <= 6);
}

NodeModel<kWidestLearningShape> make_full_node_model(const SensorModel& model,
                                                     core::Duration sample_period,
                                                     core::Duration filter_tick) {
  validate(model);
  if (sample_period <= core::Duration{} || filter_tick < sample_period) {
    throw std::invalid_argument(
        "the sample period must be positive and not longer than the filter's tick");
  }
  const double tick_s = seconds(filter_tick);
  const double arw = model.white.angle_random_walk_rad_per_sqrt_s;
  double white_variance_of_tick = arw * arw / tick_s;
  NodeModel<kWidestLearningShape> node{.sample_period = sample_period};
  Decades decades = decades_of({});
  if (model.flicker) {
    FlickerFit fit = fit_flicker(*model.flicker, tick_s);
    node.hypotheses = weigh_flickers(model, tick_s, fit);
    decades = decades_of(fit);
    white_variance_of_tick += fit.white_variance_rad2_s2;
  }
  const auto markovs = blocks_of<core::GaussMarkov, kMostGaussMarkov, GaussMarkov>(
      model.gauss_markov, "gauss_markov");
  const auto lines = blocks_of<core::Harmonic, kMostLines, Harmonic>(model.harmonic, "harmonic");
  node.modes = std::apply(
      [&](const auto&... blocks) {
        return core::compose(filter_tick, model.node.start, decades,
                             random_walk_of(model.rate_random_walk.value_or(RateRandomWalk{})),
                             warm_up_of(model.warm_up.value_or(WarmUp{.time_constant_s = 1.0})),
                             rate_ramp_of(model.rate_ramp.value_or(RateRamp{})), blocks...);
      },
      std::tuple_cat(markovs, lines));
  require_finite(node.modes);
  double white_variance = white_variance_of_tick * tick_s / seconds(sample_period);
  if (model.quantization) {
    const double step = model.quantization->step_rad_s;
    node.quantization_step_rad_s = single(step);
    if (model.quantization->method == QuantizationMethod::truncation) {
      node.truncation = {.half_step_rad_s = 0.5F * node.quantization_step_rad_s};
    }
    const float floor = core::rounding_variance(node.quantization_step_rad_s,
                                                single(arw * arw / seconds(sample_period)));
    node.measurement_floor_variance_rad2_s2 = single_or_zero(double{floor});
    white_variance += std::max(step * step / 12.0 - double{floor}, 0.0);
  }
  node.white_variance_rad2_s2 = single(white_variance);
  if (model.gate) {
    node.gate = gate_of(*model.gate, tick_s);
  }
  if (model.turn_on) {
    const double sigma = model.turn_on->sigma_rad_s;
    node.turn_on_variance_rad2_s2 = single(sigma * sigma);
  }
  if (model.zero_rate) node.largest_bias_rad_s = single(model.zero_rate->limit_rad_s);
  node.inputs = inputs_of(model);
  node.samples = samples_of(model, seconds(sample_period), tick_s);
  node.motion = motion_model_of(model);
  node.scale = scale_correction_of(model);
  if (node.white_variance_rad2_s2 == 0.0F) {
    throw std::invalid_argument("the model \"" + model.name + "\" leaves no white noise");
  }
  return node;
}

}  // namespace zerorate::model

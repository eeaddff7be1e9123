/// @file
/// Node of the C interface, and its parameters from what a caller hands over in C.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/earth_rate.hpp"
#include "core/base/time.hpp"
#include "core/standstill/odometer_traits.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/c_api/include/zerorate.h"
#include "firmware/c_api/model_checks.hpp"

namespace zerorate::c_api {

constexpr core::ModelShape kShape{.decaying = ZERORATE_DECAYING_MODES,
                                  .rotating = ZERORATE_ROTATING_MODES,
                                  .inputs = ZERORATE_TERMS,
                                  .has_accelerometer = ZERORATE_INPUTS > 0,
                                  .hypotheses = ZERORATE_HYPOTHESES};
constexpr app::NodeCapacity kCapacity{.axes = ZERORATE_AXES,
                                      .held_ticks = ZERORATE_HELD_TICKS,
                                      .average_levels = 12,
                                      .runs_moving_average = ZERORATE_HAS_MOVING_AVERAGE != 0,
                                      .runs_calibration_mean = ZERORATE_HAS_CALIBRATION_MEAN != 0,
                                      .takes_references = ZERORATE_TAKES_REFERENCES != 0};
using Node = app::GyroNode<kShape, kCapacity>;

[[nodiscard]] inline core::ModesOf<kShape> modes_of(const zerorate_model& model) {
  core::ModesOf<kShape> modes{
      .tick = core::Duration::nanoseconds(model.tick_ns),
      .start = model.starts_stationary ? core::Start::stationary : core::Start::zero,
      .is_stationary = model.is_stationary,
      .walk_variance = model.walk_variance_rad2_s2};
  for (std::size_t i = 0; i < kShape.decaying; ++i) {
    const zerorate_decaying_mode& mode = model.decaying[i];
    if (!does_something(mode)) continue;
    modes.decaying[i] = {mode.one_minus_phi, mode.noise_variance, mode.initial_variance,
                         mode.initial_mean};
  }
#if ZERORATE_ROTATING_MODES > 0
  for (std::size_t i = 0; i < kShape.rotating; ++i) {
    const zerorate_rotating_mode& mode = model.rotating[i];
    if (!does_something(mode)) continue;
    modes.rotating[i] = {{mode.one_minus_phi.re, mode.one_minus_phi.im},
                         mode.noise_variance,
                         mode.initial_variance,
                         mode.initial_mean};
  }
#endif
  return modes;
}

/// @tparam Shape kShape; a template, so that a node of one hypothesis needs none of their members
template <core::ModelShape Shape>
[[nodiscard]] core::HypothesesOf<Shape> hypotheses_of(const zerorate_model& model) {
  core::HypothesesOf<Shape> hypotheses;
  if constexpr (Shape.hypotheses > 1) {
    hypotheses.count = model.hypothesis_count;
    hypotheses.kept = model.evidence_kept;
    for (std::size_t m = 0; m < hypotheses.count; ++m) {
      const zerorate_hypothesis& given = model.hypotheses[m];
      auto& one = hypotheses.all[m];
      std::ranges::copy(given.strength, one.strength.begin());
      one.log_prior = given.log_prior;
      one.level = given.level;
      one.order = given.order;
      one.bias_instability_rad_s = given.bias_instability_rad_s;
      one.angle_random_walk_rad_per_sqrt_s = given.angle_random_walk_rad_per_sqrt_s;
    }
  }
  return hypotheses;
}

#if ZERORATE_INPUTS > 0
[[nodiscard]] inline core::Input input_of(zerorate_quantity quantity) {
  switch (quantity) {
    case ZERORATE_ACCELERATION_X:
      return core::Input::acceleration_x;
    case ZERORATE_ACCELERATION_Y:
      return core::Input::acceleration_y;
    case ZERORATE_ACCELERATION_Z:
      return core::Input::acceleration_z;
    case ZERORATE_VIBRATION:
      return core::Input::vibration;
    case ZERORATE_TEMPERATURE_RATE:
      return core::Input::temperature_rate;
    default:
      break;
  }
  return core::Input::none;
}
#endif
#if ZERORATE_TERMS > 0
[[nodiscard]] inline core::InputTerms<ZERORATE_TERMS> inputs_of(const zerorate_model& model) {
  core::InputTerms<ZERORATE_TERMS> inputs;
#if ZERORATE_TEMPERATURE
  core::TemperatureDrift{
      .reference_degc = model.temperature.reference_degc,
      .slope_rad_s_per_k = model.temperature.slope_rad_s_per_k,
      .slope_sigma_rad_s_per_k = model.temperature.slope_sigma_rad_s_per_k,
      .curvature_rad_s_per_k2 = model.temperature.curvature_rad_s_per_k2,
      .curvature_sigma_rad_s_per_k2 = model.temperature.curvature_sigma_rad_s_per_k2,
      .lag_s = model.temperature.lag_s}
      .put_into(inputs);
#endif
#if ZERORATE_INPUTS > 0
  for (std::size_t i = 0; i < ZERORATE_INPUTS; ++i) {
    const zerorate_input& given = model.inputs[i];
    core::InputTerm& term = inputs.terms[ZERORATE_TERMS - ZERORATE_INPUTS + i];
    term.input = input_of(given.quantity);
    term.sigma = given.sigma;
    std::copy_n(given.coefficient, ZERORATE_AXES, term.coefficient.begin());
  }
#endif
  return inputs;
}
#endif

/// Zeros are what is usual.
[[nodiscard]] inline core::MotionModel motion_of(const zerorate_model& model) {
  constexpr core::MotionModel kUsual;
  const auto given_or = [](float given, float usual) { return given > 0.0F ? given : usual; };
  return {.scale_factor = given_or(model.scale_factor_sigma, kUsual.scale_factor),
          .asymmetry = model.asymmetry_sigma,
          .slope_variance_rad2 = model.slope_variance_rad2,
          .scale_factor_per_k = given_or(model.scale_factor_sigma_per_k, kUsual.scale_factor_per_k),
          .scale_factor_at_k = given_or(model.scale_factor_at_k, kUsual.scale_factor_at_k)};
}
[[nodiscard]] inline core::ScaleCorrection scale_of(const zerorate_model& model) {
  core::ScaleCorrection scale;
  for (std::size_t i = 0; i < ZERORATE_AXES; ++i) {
    scale.factor[i] = core::ScaleCorrection::factor_of(model.scale_factor_error[i]);
  }
  return scale;
}

[[nodiscard]] inline app::Predictor predictor_of(zerorate_predictor predictor) {
  switch (predictor) {
    case ZERORATE_MOVING_AVERAGE:
      return app::Predictor::moving_average;
    case ZERORATE_CALIBRATION_MEAN:
      return app::Predictor::calibration_mean;
    default:
      break;
  }
  return app::Predictor::kalman;
}

[[nodiscard]] inline std::optional<core::UpAxis> up_axis_of(const zerorate_config& config) {
  if (config.up_axis == 0) return std::nullopt;
  const bool points_down = config.up_axis < 0;
  const int axis = (points_down ? -config.up_axis : config.up_axis) - 1;
  return core::UpAxis{.axis = static_cast<std::uint8_t>(axis), .points_down = points_down};
}
[[nodiscard]] inline core::EarthRate earth_of(const zerorate_config& config) {
  const auto up = up_axis_of(config);
  if (up) return core::earth_rate(config.latitude_deg, *up);
  // An accelerometer finds the vertical.
  const bool is_stated = kShape.has_accelerometer && config.latitude_deg != 0.0F;
  return is_stated ? core::earth_rate(config.latitude_deg, core::UpAxis{}) : core::EarthRate{};
}

[[nodiscard]] inline core::StandstillSource source_of(zerorate_standstill standstill) {
  switch (standstill) {
    case ZERORATE_BY_GYRO:
      return core::StandstillSource::gyro;
    case ZERORATE_BY_ODOMETER_ALONE:
      return core::StandstillSource::odometer_alone;
    default:
      break;
  }
  return core::StandstillSource::odometer;
}

[[nodiscard]] inline core::Standstill::Params standstill_of(const zerorate_config& config) {
  const core::OdometerTraits odometer{
      .dead_band_mps = config.odometer_dead_band_mps,
      .latency = core::Duration::nanoseconds(config.odometer_latency_ns)};
  return core::adapted_to(odometer, {.settle = core::Duration::nanoseconds(config.settle_ns),
                                     .hold_back = core::Duration::nanoseconds(config.hold_back_ns),
                                     .source = source_of(config.standstill)});
}

[[nodiscard]] inline Node::Params params_of(const zerorate_model& model,
                                            const zerorate_config& config) {
  const bool is_known = model.turn_on_variance_rad2_s2 >= 0.0F;
  const core::NodeModel<kShape> noise {
    .modes = modes_of(model), .white_variance_rad2_s2 = model.white_variance_rad2_s2,
    .measurement_floor_variance_rad2_s2 = model.measurement_floor_variance_rad2_s2,
    .turn_on_variance_rad2_s2 =
        is_known ? model.turn_on_variance_rad2_s2 : std::numeric_limits<float>::infinity(),
    .largest_bias_rad_s = model.largest_bias_rad_s > 0.0F ? model.largest_bias_rad_s
                                                          : std::numeric_limits<float>::infinity(),
    .gate = {.threshold_sigma = model.gate_threshold_sigma,
             .longest_knock_ticks = model.gate_longest_knock_ticks},
#if ZERORATE_TERMS > 0
    .inputs = inputs_of(model),
#endif
    .motion = motion_of(model), .scale = scale_of(model),
    .sample_period = core::Duration::nanoseconds(model.sample_period_ns),
    .hypotheses = hypotheses_of<kShape>(model),
    .quantization_step_rad_s = model.truncation_step_rad_s, .truncation = {
      .half_step_rad_s = 0.5F * model.truncation_step_rad_s
    }
  };
  return {.model = noise,
          .standstill = standstill_of(config),
          .earth = earth_of(config),
          .up = up_axis_of(config),
          .published = predictor_of(config.predictor)};
}

}  // namespace zerorate::c_api

/// @file
/// From a sensor model and two rates to the coefficients that run on the node.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "core/base/time.hpp"
#include "core/model/node_model.hpp"
#include "core/noise/inputs.hpp"
#include "core/noise/model_shape.hpp"
#include "firmware/model/hypotheses.hpp"
#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

/// Limits that no model exceeds.
inline constexpr std::size_t kMostDecades = 8;
inline constexpr std::size_t kMostGaussMarkov = 2;
inline constexpr std::size_t kMostLines = 2;
/// Shape of every model without [[input]] tables.
inline constexpr core::ModelShape kLargestShape{
    .decaying = kMostDecades + kMostGaussMarkov + 2,  // warm-up, ramp
    .rotating = kMostLines,
    .inputs = core::TemperatureDrift::kTerms};
/// Shape of the same models, with every hypothesis.
inline constexpr core::ModelShape kLargestLearningShape =
    core::with_hypotheses(kLargestShape, kMostHypotheses);

[[nodiscard]] constexpr core::ModelShape with_accelerometer(core::ModelShape shape) {
  shape.has_accelerometer = true;
  return shape;
}
/// A shape with room for every input.
[[nodiscard]] constexpr core::ModelShape with_all_inputs(core::ModelShape shape) {
  shape.inputs = core::kInputs - 1;
  return with_accelerometer(shape);
}
/// Shape of every model.
inline constexpr core::ModelShape kWidestShape = with_all_inputs(kLargestShape);
inline constexpr core::ModelShape kWidestLearningShape = with_all_inputs(kLargestLearningShape);

template <core::ModelShape Shape>
using NodeModel = core::NodeModel<Shape>;

/// Whether the model consists of at most six decades, a random walk, and terms without a state.
/// Then it runs in a node of six decaying modes.
[[nodiscard]] bool fits_six_decades(const SensorModel& model);

/// The model of a node that reads no accelerometer: without the inputs that such a node ignores.
[[nodiscard]] SensorModel without_accelerometer(SensorModel model);
/// The model of a node, by whether it reads an accelerometer.
[[nodiscard]] inline SensorModel for_node(const SensorModel& model, bool has_accelerometer) {
  return has_accelerometer ? model : without_accelerometer(model);
}

/// Calls `run` with the shape of the filter for a model as a template argument: six decades where
/// they are enough, otherwise `Largest`, where need be with all inputs.
/// @param has_accelerometer whether the node is given the specific force: a witness of motion and
///   of the vertical, whatever the model follows
template <core::ModelShape Largest, class Run>
auto with_shape_of(const SensorModel& sensor, bool has_accelerometer, Run run) {
  const SensorModel model = for_node(sensor, has_accelerometer);
  constexpr core::ModelShape kSixDecades{.decaying = 6, .hypotheses = Largest.hypotheses};
  if constexpr (Largest.inputs > 0) {
    if (has_accelerometer && fits_six_decades(model)) {
      return run.template operator()<with_accelerometer(kSixDecades)>();
    }
    if (has_accelerometer || !model.inputs.empty()) {
      return run.template operator()<with_all_inputs(Largest)>();
    }
  }
  if (fits_six_decades(model)) return run.template operator()<kSixDecades>();
  return run.template operator()<Largest>();
}

namespace detail {
template <class Mode>
[[nodiscard]] constexpr bool is_active(const Mode& mode) {
  return mode.noise_variance > 0.0F || mode.initial_variance > 0.0F || mode.initial_mean != 0.0F;
}
/// Moves the modes of one kind with an effect to the front, and returns their number.
/// @param moved called with the old and the new place of each
template <class Mode, std::size_t N, class Moved>
[[nodiscard]] constexpr std::size_t move_active_to_front(std::array<Mode, N>& modes, Moved moved) {
  std::size_t active = 0;
  for (std::size_t i = 0; i < N; ++i) {
    const Mode mode = modes[i];
    if (!is_active(mode)) continue;
    moved(i, active);
    modes[active++] = mode;
  }
  return active;
}
}  // namespace detail

/// Number of the terms of a model; they stand first.
template <std::size_t K>
[[nodiscard]] constexpr std::size_t count_inputs(const core::InputTerms<K>& inputs) {
  return static_cast<std::size_t>(
      std::count_if(inputs.terms.begin(), inputs.terms.end(),
                    [](const auto& term) { return term.input != core::Input::none; }));
}

/// Modes of a model with an effect; they stand first.
struct ActiveModes {
  std::size_t decaying = 0;
  std::size_t rotating = 0;
};

/// The model at its full size, unused modes being zero.
///
/// The steps of a quantizer are noise of step^2 / 12. Averaging removes the share that the white
/// noise of a sample moves from step to step (Widrow and Kollar 2008).
/// White noise of a sample is N^2 / sample_period and the share of the flicker fit that is white at
/// the tick, so that the mean over a tick has N^2 / filter_tick and that share.
/// Throws std::invalid_argument for an impossible model (see validate()), unless
/// 0 < sample_period <= filter_tick, and where single precision cannot hold the coefficients or
/// nothing white is left (a filter needs some: it never trusts a single sample completely).
[[nodiscard]] NodeModel<kWidestLearningShape> make_full_node_model(const SensorModel& model,
                                                                   core::Duration sample_period,
                                                                   core::Duration filter_tick);

/// Moves the modes that do something to the front, and the strengths of the hypotheses with them.
template <core::ModelShape Shape>
[[nodiscard]] constexpr ActiveModes move_active_to_front(NodeModel<Shape>& node) {
  const auto move_strengths = [&](std::size_t from, std::size_t to) {
    for (auto& one : node.hypotheses.all) one.strength[to] = one.strength[from];
  };
  return {.decaying = detail::move_active_to_front(node.modes.decaying, move_strengths),
          .rotating =
              detail::move_active_to_front(node.modes.rotating, [](std::size_t, std::size_t) {})};
}

/// Makes the model of a node of this shape. Lags that the flicker fit gave no weight take no place.
/// Also throws std::invalid_argument where the model needs more.
template <core::ModelShape Shape>
[[nodiscard]] NodeModel<Shape> make_node_model(const SensorModel& model,
                                               core::Duration sample_period,
                                               core::Duration filter_tick) {
  auto full =
      make_full_node_model(for_node(model, Shape.has_accelerometer), sample_period, filter_tick);
  const auto [decaying, rotating] = move_active_to_front(full);
  if (decaying > Shape.decaying || rotating > Shape.rotating) {
    throw std::invalid_argument(
        "the model \"" + model.name + "\" needs " + std::to_string(decaying) + " decaying and " +
        std::to_string(rotating) + " rotating modes; this node has " +
        std::to_string(Shape.decaying) + " and " + std::to_string(Shape.rotating));
  }
  if (count_inputs(full.inputs) > Shape.inputs ||
      (full.inputs.follows(core::is_inertial) && !Shape.has_accelerometer)) {
    throw std::invalid_argument("the model \"" + model.name +
                                "\" follows inputs for which this node has no room");
  }
  NodeModel<Shape> fitting;
  fitting.modes.tick = full.modes.tick;
  fitting.modes.start = full.modes.start;
  fitting.modes.is_stationary = full.modes.is_stationary;
  fitting.modes.walk_variance = full.modes.walk_variance;
  std::copy_n(full.modes.decaying.begin(), decaying, fitting.modes.decaying.begin());
  std::copy_n(full.modes.rotating.begin(), rotating, fitting.modes.rotating.begin());
  fitting.white_variance_rad2_s2 = full.white_variance_rad2_s2;
  fitting.measurement_floor_variance_rad2_s2 = full.measurement_floor_variance_rad2_s2;
  fitting.turn_on_variance_rad2_s2 = full.turn_on_variance_rad2_s2;
  fitting.largest_bias_rad_s = full.largest_bias_rad_s;
  fitting.gate = full.gate;
  if constexpr (Shape.inputs > 0) {
    fitting.inputs.reference_degc = full.inputs.reference_degc;
    fitting.inputs.lag_s = full.inputs.lag_s;
    std::copy_n(full.inputs.terms.begin(), Shape.inputs, fitting.inputs.terms.begin());
  }
  fitting.samples = full.samples;
  fitting.motion = full.motion;
  fitting.scale = full.scale;
  fitting.sample_period = full.sample_period;
  fitting.quantization_step_rad_s = full.quantization_step_rad_s;
  fitting.truncation = full.truncation;
  if constexpr (Shape.hypotheses > 1) {
    static_assert(Shape.hypotheses == kMostHypotheses);
    fitting.hypotheses.count = full.hypotheses.count;
    fitting.hypotheses.kept = full.hypotheses.kept;
    for (std::size_t m = 0; m < full.hypotheses.count; ++m) {
      const auto& one = full.hypotheses.all[m];
      auto& fits = fitting.hypotheses.all[m];
      fits = {.strength = {},
              .log_prior = one.log_prior,
              .level = one.level,
              .order = one.order,
              .bias_instability_rad_s = one.bias_instability_rad_s,
              .angle_random_walk_rad_per_sqrt_s = one.angle_random_walk_rad_per_sqrt_s};
      std::copy_n(one.strength.begin(), decaying, fits.strength.begin());
    }
  }
  return fitting;
}

}  // namespace zerorate::model

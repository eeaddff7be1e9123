/// @file
/// The inputs of the bias in a message: vibration, and what each kind of input explains.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/numeric.hpp"
#include "core/base/units.hpp"
#include "core/inputs/tick_inputs.hpp"
#include "firmware/app/node_params.hpp"
#include "firmware/app/rate_message.hpp"

namespace zerorate::app {

/// Share of an input in what is explained.
[[nodiscard]] constexpr core::AngularRate ExplainedBias::*share_of(core::Input input) {
  switch (core::source_of(input)) {
    case core::InputSource::thermometer:
      return &ExplainedBias::temperature;
    case core::InputSource::accelerometer:
      return &ExplainedBias::acceleration;
    case core::InputSource::vibration:
      break;
  }
  return &ExplainedBias::vibration;
}

/// Adds the vibration within the newest tick that showed one, where a force is known.
template <class Ticks>
constexpr void describe_vibration(const Ticks& ticks, RateMessage& message) {
  const auto& accelerometer = ticks.inputs().accelerometer();
  if (!accelerometer.has_vibration() || !accelerometer.is_known(message.time)) return;
  message.vibration =
      core::standard_gravity(core::square_root(accelerometer.last_tick().vibration_g2));
}

/// Adds what the inputs explain of the bias, if the published predictor learns their coefficients.
template <class Ticks>
constexpr void describe_explained(const Ticks& ticks, RateMessage& message) {
  const auto& inputs = ticks.params().model.inputs;
  const bool has_inputs = inputs.follows([](core::Input) { return true; });
  if (ticks.params().published != Predictor::kalman || !has_inputs) return;
  auto& explained = message.explained.emplace();
  for (std::size_t i = 0; i < Ticks::InputTrack::kInputs; ++i) {
    if (!inputs.terms[i].is_on()) continue;
    const float weight = ticks.inputs().tick().weights[i];
    for (std::size_t axis = 0; axis < Ticks::kAxes; ++axis) {
      core::AngularRate& share = explained[axis].*share_of(inputs.terms[i].input);
      share = share + core::rad_per_s(ticks.predictors().bank().coefficient(i, axis) * weight);
    }
  }
}

/// Adds what is known of the inputs at a message's sample. Nothing in a node without inputs, at no
/// cost. Cost: a multiplication and an addition for each hypothesis, axis and input.
/// @param ticks a TickNode
template <class Ticks>
constexpr void describe_inputs([[maybe_unused]] const Ticks& ticks,
                               [[maybe_unused]] RateMessage& message) {
  if constexpr (Ticks::kHasAccelerometer) describe_vibration(ticks, message);
  if constexpr (Ticks::InputTrack::kInputs > 0) describe_explained(ticks, message);
}

}  // namespace zerorate::app

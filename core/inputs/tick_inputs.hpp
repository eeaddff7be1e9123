/// @file
/// The inputs of one tick of the filter.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/numeric.hpp"
#include "core/noise/inputs.hpp"

namespace zerorate::core {

/// Sources of inputs. Those of one source are unknown together.
enum class InputSource : std::uint8_t { thermometer, accelerometer, vibration };

[[nodiscard]] constexpr InputSource source_of(Input input) {
  if (input == Input::vibration) return InputSource::vibration;
  return is_inertial(input) ? InputSource::accelerometer : InputSource::thermometer;
}

/// Inputs of a tick, as far as they are known. A record holds them: floats without padding.
template <ModelShape Shape>
struct TickInputs {
  static constexpr std::size_t kSources = Shape.has_accelerometer ? 3 : 1;

  std::array<float, Shape.inputs>
      weights{};  ///< values in the order of InputTerms; the last known ones
  /// How long each source had not measured when the tick began; 0: it measures.
  std::array<float, kSources> unknown_s{};

  constexpr bool operator==(const TickInputs&) const = default;
  [[nodiscard]] constexpr float unknown_for_s(InputSource source) const {
    return unknown_s[static_cast<std::size_t>(source)];
  }
  [[nodiscard]] constexpr bool is_known(InputSource source) const {
    return unknown_for_s(source) == 0.0F;
  }
  /// True if restored inputs are valid.
  [[nodiscard]] static bool is_possible(const TickInputs& tick) {
    return are_plausible(tick.weights) && are_plausible_variances(tick.unknown_s);
  }
};
template <ModelShape Shape>
requires(Shape.inputs == 0) struct TickInputs<Shape> {
  constexpr bool operator==(const TickInputs&) const = default;
  [[nodiscard]] static constexpr bool is_possible(const TickInputs& /*tick*/) { return true; }
};

/// Temperature of a tick [degC]; no number where it is unknown, or is no input.
template <ModelShape Shape>
[[nodiscard]] constexpr float temperature_degc(
    [[maybe_unused]] const InputBlock<Shape.inputs>& inputs,
    [[maybe_unused]] const TickInputs<Shape>& tick) {
  if constexpr (Shape.inputs > 0) {
    for (std::size_t i = 0; i < Shape.inputs && tick.is_known(InputSource::thermometer); ++i) {
      if (inputs.terms[i].input == Input::temperature) {
        return tick.weights[i] + inputs.reference_degc;
      }
    }
  }
  return std::numeric_limits<float>::quiet_NaN();
}
/// Inputs of a tick of which the temperature alone is known, if it is a number.
template <ModelShape Shape>
[[nodiscard]] constexpr TickInputs<Shape> inputs_at(
    [[maybe_unused]] const InputBlock<Shape.inputs>& inputs, [[maybe_unused]] float degc) {
  TickInputs<Shape> tick;
  if constexpr (Shape.inputs > 0) {
    constexpr float kUnknown_s = 1.0F;
    tick.unknown_s.fill(kUnknown_s);
    if (!is_finite(degc)) return tick;
    tick.unknown_s[0] = 0.0F;
    const float e_k = degc - inputs.reference_degc;
    for (std::size_t i = 0; i < Shape.inputs; ++i) {
      if (inputs.terms[i].input == Input::temperature) tick.weights[i] = e_k;
      if (inputs.terms[i].input == Input::temperature_squared) tick.weights[i] = e_k * e_k;
    }
  }
  return tick;
}

/// Standard deviation of the change of an input that nothing measured for a time. A temperature
/// wanders by 0.1 K in a second and 6 K in an hour, as in a car's cabin; its rate of change is
/// 1 K a minute. A specific force wanders by 0.1 g in a second up to 1 g; a vibration is that of a
/// car on a road.
/// @param e_k last known temperature above the reference
[[nodiscard]] constexpr float unknown_change(Input input, float e_k, float unknown_s) {
  constexpr float kWander_k2_per_s = 0.01F;
  constexpr float kWander_g2_per_s = 0.01F;
  constexpr float kLargest_g2 = 1.0F;
  constexpr float kRate_k_s = 1.0F / 60.0F;
  constexpr float kVibration_g2 = 0.01F;
  if (!(unknown_s > 0.0F)) return 0.0F;
  switch (input) {
    case Input::none:
      return 0.0F;
    case Input::temperature:
      return square_root(kWander_k2_per_s * unknown_s);
    case Input::temperature_squared:
      return 2.0F * e_k * square_root(kWander_k2_per_s * unknown_s);
    case Input::temperature_rate:
      return kRate_k_s;
    case Input::vibration:
      return kVibration_g2;
    default:
      break;
  }
  const float wander_g2 = kWander_g2_per_s * unknown_s;
  return square_root(wander_g2 < kLargest_g2 ? wander_g2 : kLargest_g2);
}

}  // namespace zerorate::core

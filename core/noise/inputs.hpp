/// @file
/// Inputs of the bias: what a node measures beside the rate, and the share of the bias that
/// follows.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// Quantity that a share of the bias is proportional to.
enum class Input : std::uint8_t {
  none,                 ///< place that the model does not use
  temperature,          ///< e: sensing element above the reference [K]
  temperature_squared,  ///< e^2 [K2]
  temperature_rate,     ///< change of e, smoothed over a minute [K/s]
  acceleration_x,       ///< specific force along an axis of the chip [g]
  acceleration_y,
  acceleration_z,
  vibration,  ///< variance of the specific force within a tick, summed over the axes [g2]
};
inline constexpr std::size_t kInputs = 8;

/// Whether a thermometer measures an input; the others are an accelerometer's.
[[nodiscard]] constexpr bool is_thermal(Input input) {
  return input >= Input::temperature && input <= Input::temperature_rate;
}
[[nodiscard]] constexpr bool is_inertial(Input input) {
  return input >= Input::acceleration_x;
}
/// Whether the unseen changes of two inputs go together: those of one temperature do.
[[nodiscard]] constexpr bool change_together(Input a, Input b) {
  return a == b || (is_thermal(a) && is_thermal(b));
}

/// A term of the bias: coefficient times input. The coefficient is a constant of the sensor with a
/// roughly known value, which a filter learns; the input is its weight in a measurement.
struct InputTerm {
  Input input = Input::none;
  float sigma = 0.0F;                  ///< deviation of the coefficient [rad/s per unit of the input]
  std::array<float, 3> coefficient{};  ///< expected on x, y and z [rad/s per unit of the input]

  constexpr bool operator==(const InputTerm&) const = default;
  [[nodiscard]] constexpr bool is_on() const {
    return input != Input::none &&
           (sigma > 0.0F || std::any_of(coefficient.begin(), coefficient.end(),
                                        [](float one) { return one != 0.0F; }));
  }
};

/// Terms of a filter with K of them.
template <std::size_t K>
struct InputTerms {
  std::array<InputTerm, K> terms{};
  float reference_degc = 0.0F;
  float lag_s = 0.0F;  ///< first-order lag of the sensing element behind the thermometer; 0: none

  constexpr bool operator==(const InputTerms&) const = default;
  /// Whether a term that is on satisfies a condition on its input.
  template <class Condition>
  [[nodiscard]] constexpr bool follows(Condition condition) const {
    return std::any_of(terms.begin(), terms.end(), [&](const InputTerm& term) {
      return term.is_on() && condition(term.input);
    });
  }
};

/// Block of a filter without inputs.
struct NoInputTerms {
  constexpr bool operator==(const NoInputTerms&) const = default;
  template <class Condition>
  [[nodiscard]] static constexpr bool follows(Condition /*condition*/) {
    return false;
  }
};

/// @tparam K 0 or number of terms
template <std::size_t K>
using InputBlock = std::conditional_t<(K > 0), InputTerms<K>, NoInputTerms>;

/// A bias that follows the temperature: slope e + curvature e^2 on each axis.
struct TemperatureDrift {
  static constexpr std::size_t kTerms = 2;

  float reference_degc = 0.0F;
  float slope_rad_s_per_k = 0.0F;  ///< expected
  float slope_sigma_rad_s_per_k = 0.0F;
  float curvature_rad_s_per_k2 = 0.0F;
  float curvature_sigma_rad_s_per_k2 = 0.0F;
  float lag_s = 0.0F;  ///< first-order lag of the sensing element behind the thermometer; 0: none

  /// Puts slope and curvature into the first two terms.
  template <std::size_t K>
  constexpr void put_into(InputTerms<K>& inputs) const {
    static_assert(K >= kTerms);
    const auto on_all_axes = [](float value) { return std::array{value, value, value}; };
    inputs.reference_degc = reference_degc;
    inputs.lag_s = lag_s;
    inputs.terms[0] = {Input::temperature, slope_sigma_rad_s_per_k, on_all_axes(slope_rad_s_per_k)};
    inputs.terms[1] = {Input::temperature_squared, curvature_sigma_rad_s_per_k2,
                       on_all_axes(curvature_rad_s_per_k2)};
  }
  [[nodiscard]] constexpr InputTerms<kTerms> terms() const {
    InputTerms<kTerms> inputs;
    put_into(inputs);
    return inputs;
  }
};

/// Effect of K inputs on the bias over a span of ticks.
template <std::size_t K>
struct InputTransition {
  using Weights = std::array<float, K>;

  Weights change{};  ///< change of the weights from before the span to its end
  Weights sum{};     ///< sum over the ticks of the span of the change up to each
  /// Standard deviations of the changes that nothing measured, with mean zero.
  Weights unknown{};

  constexpr bool operator==(const InputTransition&) const = default;

  [[nodiscard]] constexpr bool is_known() const {
    return std::all_of(unknown.begin(), unknown.end(), [](float sigma) { return sigma == 0.0F; });
  }
};

/// Transition of the modes together with the effect of the inputs.
template <ModelShape Shape>
struct TransitionWithInputs : TransitionOf<Shape> {
  InputTransition<Shape.inputs> inputs{};

  constexpr bool operator==(const TransitionWithInputs&) const = default;
};

/// Transition type of a filter; without inputs it is that of its modes.
template <ModelShape Shape>
using FilterTransition =
    std::conditional_t<(Shape.inputs > 0), TransitionWithInputs<Shape>, TransitionOf<Shape>>;

}  // namespace zerorate::core

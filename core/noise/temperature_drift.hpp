/// @file
/// The share of the bias that follows the temperature.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// slope e + curvature e^2 with e = temperature - reference. Both coefficients are constants of the
/// sensor with a roughly known value that a filter learns; e and e^2 are the weights of both in a
/// measurement.
struct TemperatureDrift {
  static constexpr std::size_t kWeights = 2;

  float reference_degc = 0.0F;
  float slope_rad_s_per_k = 0.0F;  ///< expected
  float slope_sigma_rad_s_per_k = 0.0F;
  float curvature_rad_s_per_k2 = 0.0F;
  float curvature_sigma_rad_s_per_k2 = 0.0F;
  float lag_s = 0.0F;  ///< first-order lag of the sensing element behind the thermometer; 0: none

  constexpr bool operator==(const TemperatureDrift&) const = default;
  [[nodiscard]] constexpr bool is_on() const {
    return slope_rad_s_per_k != 0.0F || slope_sigma_rad_s_per_k > 0.0F ||
           curvature_rad_s_per_k2 != 0.0F || curvature_sigma_rad_s_per_k2 > 0.0F;
  }
};

/// Empty block of a filter without temperature (K = 0).
struct NoTemperatureDrift {
  constexpr bool operator==(const NoTemperatureDrift&) const = default;
};

/// @tparam K 0 or TemperatureDrift::kWeights
template <std::size_t K>
using TemperatureBlock = std::conditional_t<(K > 0), TemperatureDrift, NoTemperatureDrift>;

/// Effect of the temperature on the bias over a span of ticks.
template <std::size_t K>
struct TemperatureTransition {
  static_assert(K == TemperatureDrift::kWeights);
  using Weights = std::array<float, K>;

  Weights change{};  ///< change of the weights from before the span to its end
  Weights sum{};     ///< sum over the ticks of the span of the change up to each
  /// Standard deviation of the change while the temperature is not known. Both weights then change
  /// together, with mean zero.
  Weights unknown{};

  constexpr bool operator==(const TemperatureTransition&) const = default;

  [[nodiscard]] constexpr bool is_known() const { return unknown[0] == 0.0F; }
};

/// Transition of the modes together with the effect of the temperature.
template <ModelShape Shape>
struct TransitionWithTemperature : TransitionOf<Shape> {
  TemperatureTransition<Shape.temperature_weights> temperature{};

  constexpr bool operator==(const TransitionWithTemperature&) const = default;
};

/// Transition type of a filter; without temperature it is that of its modes.
template <ModelShape Shape>
using FilterTransition = std::conditional_t<(Shape.temperature_weights > 0),
                                            TransitionWithTemperature<Shape>, TransitionOf<Shape>>;

}  // namespace zerorate::core

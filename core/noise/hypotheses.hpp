/// @file
/// Hypotheses of a sensor's slow noise, around the model of its data sheet.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include "core/base/numeric.hpp"
#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// Flicker noise that the sensor may have, in the modes of the model (docs/design/learning.md,
/// section 1). All figures hold for the model's white noise; a filter learns the factor of both.
/// @tparam Decaying number of decaying modes
template <std::size_t Decaying>
struct NoiseHypothesis {
  std::array<float, Decaying> strength{};  ///< variance of each mode over the model's
  float log_prior = 0.0F;               ///< logarithm of the prior probability, less any constant
  float level = 1.0F;                   ///< slow noise over half a minute, over the model's
  float order = 0.0F;                   ///< d
  float bias_instability_rad_s = 0.0F;  ///< B
  float angle_random_walk_rad_per_sqrt_s = 0.0F;  ///< N

  constexpr bool operator==(const NoiseHypothesis&) const = default;
  /// Evidence before the first measurement. It favours strong noise, because few measurements may
  /// favour too weak a noise by chance. It is forgotten like all evidence.
  [[nodiscard]] constexpr float first_log_evidence() const {
    constexpr float kCaution = 1.0F / 3.0F;
    return kCaution * natural_log(std::max(level, 1e-37F));
  }
};

/// Hypotheses of a filter of this shape, with the memory of their evidence.
template <ModelShape Shape>
struct Hypotheses {
  std::size_t count = 0;  ///< hypotheses in use; 0: the model is known, and nothing is learnt
  /// Share of the evidence that a measurement leaves; 1: all of it.
  float kept = 1.0F;
  std::array<NoiseHypothesis<Shape.decaying>, Shape.hypotheses> all{};

  constexpr bool operator==(const Hypotheses&) const = default;
};

/// No hypotheses: the filter uses the model itself.
struct KnownModel {
  static constexpr std::size_t count = 0;

  constexpr bool operator==(const KnownModel&) const = default;
};

template <ModelShape Shape>
using HypothesesOf = std::conditional_t<(Shape.hypotheses > 1), Hypotheses<Shape>, KnownModel>;

}  // namespace zerorate::core

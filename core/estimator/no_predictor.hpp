/// @file
/// The place of a predictor that a node does without.
#pragma once

#include "core/estimator/prediction.hpp"
#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// BiasPredictor that learns nothing and predicts nothing, at no cost.
template <ModelShape Shape>
class NoPredictor {
 public:
  using Coefficients = ModesOf<Shape>;
  using Transition = TransitionOf<Shape>;
  struct State {
    constexpr bool operator==(const State&) const = default;
  };

  constexpr explicit NoPredictor(const Coefficients& /*modes*/) {}
  [[nodiscard]] constexpr const State& state() const { return kState; }
  constexpr void restore(const State& /*state*/) {}
  [[nodiscard]] static constexpr bool is_possible(const State& /*state*/) { return true; }
  constexpr void begin_stop() {}
  constexpr void advance(const Transition& /*span*/) {}
  constexpr Innovation observe(float /*rate_rad_s*/, float /*white_variance*/) { return {}; }
  constexpr Innovation step(const Transition& /*span*/, float /*rate_rad_s*/,
                            float /*white_variance*/) {
    return {};
  }
  [[nodiscard]] constexpr float bias_rad_s(const Transition& /*lead*/) const { return 0.0F; }
  [[nodiscard]] constexpr Prediction predict(const Transition& /*lead*/) const { return {}; }
  [[nodiscard]] constexpr HeadingPrediction predict_heading(const Transition& /*lead*/,
                                                            const Transition& /*drive*/) const {
    return {};
  }

 private:
  static constexpr State kState{};
};

}  // namespace zerorate::core

/// @file
/// Interface of all bias predictors, and the empty predictor of a node without one.
#pragma once

#include <concepts>
#include <cstdint>

#include "core/estimator/prediction.hpp"
#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// A predictor lives at the tick of its newest measurement. It is fed with the means of ticks at
/// standstill and asked for any later tick; between stops nothing is computed.
///
/// - `Coefficients`: made from core::Modes, shared by the predictors of all axes.
/// - `begin_stop()`: a new standstill begins. Predictors without memory across stops start again.
/// - `advance(span)`: time passes. Call it before each measurement with the span since the last.
/// - `observe(rate, variance)`: the mean measured rate of this tick [rad/s] and its white variance.
/// - `step(span, rate, variance)`: both in one, which may be quicker.
/// - `bias_rad_s(lead)`: the bias `lead` after the newest measurement; before the first, 0.
/// - `predict(lead)`: the same with its variance, which costs more.
/// - `predict_heading(lead, drive)`: the integral of the bias over the ticks of `drive`, which
///   begins `lead` after the newest measurement.
template <class P>
concept BiasPredictor = requires(P predictor, const P& settled, const typename P::Transition& span,
                                 float rate_rad_s, float variance_rad2_s2) {
  typename P::State;
  typename P::Coefficients;
  { predictor.begin_stop() } -> std::same_as<void>;
  { predictor.advance(span) } -> std::same_as<void>;
  { predictor.observe(rate_rad_s, variance_rad2_s2) } -> std::same_as<Innovation>;
  { predictor.step(span, rate_rad_s, variance_rad2_s2) } -> std::same_as<Innovation>;
  { settled.bias_rad_s(span) } -> std::same_as<float>;
  { settled.predict(span) } -> std::same_as<Prediction>;
  { settled.predict_heading(span, span) } -> std::same_as<HeadingPrediction>;
  { settled.state() } -> std::same_as<const typename P::State&>;
};

/// Empty BiasPredictor: every function is a no-op at no cost.
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
  [[nodiscard]] constexpr std::uint32_t window(const Transition& /*lead*/) const { return 0; }
  [[nodiscard]] constexpr Prediction predict(const Transition& /*lead*/) const { return {}; }
  [[nodiscard]] constexpr Prediction predict(const Transition& /*lead*/,
                                             const Transition& /*averaged*/) const {
    return {};
  }
  [[nodiscard]] constexpr HeadingPrediction predict_heading(const Transition& /*lead*/,
                                                            const Transition& /*drive*/) const {
    return {};
  }

 private:
  static constexpr State kState{};
};

}  // namespace zerorate::core

/// @file
/// The Kalman predictor of one axis.
#pragma once

#include "core/estimator/kalman_bank.hpp"

namespace zerorate::core {

/// KalmanBank of a single axis, as a BiasPredictor.
template <ModelShape Shape>
class KalmanPredictor {
 public:
  using Bank = KalmanBank<Shape, 1>;
  using Coefficients = KalmanCoefficients<Shape>;
  using Transition = typename Bank::Transition;
  using State = typename Bank::State;

  /// @param coefficients must outlive the predictor
  constexpr explicit KalmanPredictor(const Coefficients& coefficients) : bank_(coefficients) {}

  [[nodiscard]] constexpr const State& state() const { return bank_.state(); }
  constexpr void restore(const State& state) { bank_.restore(state); }

  /// The filter remembers across stops: nothing to do.
  constexpr void begin_stop() {}
  constexpr void advance(const Transition& span) { bank_.advance(span); }
  constexpr Innovation observe(float rate_rad_s, float white_variance) {
    return bank_.observe({rate_rad_s}, white_variance)[0];
  }
  constexpr Innovation step(const Transition& span, float rate_rad_s, float white_variance) {
    advance(span);
    return observe(rate_rad_s, white_variance);
  }
  constexpr void inflate_variance(float variance_rad2_s2) {
    bank_.inflate_variance(variance_rad2_s2);
  }
  constexpr void restart_transients() { bank_.restart_transients(); }

  [[nodiscard]] constexpr float bias_rad_s(const Transition& lead) const {
    return bank_.bias_rad_s(lead, 0);
  }
  [[nodiscard]] constexpr Prediction predict(const Transition& lead) const {
    return bank_.predict(lead)[0];
  }
  [[nodiscard]] constexpr HeadingPrediction predict_heading(const Transition& lead,
                                                            const Transition& drive) const {
    return bank_.predict_heading(lead, drive)[0];
  }

 private:
  Bank bank_;
};

}  // namespace zerorate::core

/// @file
/// The noise in the coordinates of the Kalman filter.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/estimator/forgetting.hpp"
#include "core/estimator/gate.hpp"
#include "core/noise/hypotheses.hpp"
#include "core/noise/inputs.hpp"
#include "core/noise/model_shape.hpp"

namespace zerorate::core {

/// Hypotheses of a filter whose model is known.
template <ModelShape Shape>
inline constexpr HypothesesOf<Shape> kKnownModel{};
/// Terms of a filter whose bias follows no input.
template <ModelShape Shape>
inline constexpr InputBlock<Shape.inputs> kNoInputs{};

/// The filter does not hold a mode z but its drift w = beta z, scaled so that the bias moves over
/// one tick by the plain sum of the drifts: w = -alpha z for a decaying mode; for a rotating one
/// beta = -(1 + j) alpha / 2, so that the sum of its two components is Re(-alpha z).
/// docs/design/kalman-predictor.md, eq. 6.
///
/// Behind the drifts of the modes stand the coefficients of the inputs, if the filter follows any:
/// constants, which move the bias by the changes of their weights.
template <ModelShape Shape>
struct KalmanCoefficients {
  static constexpr std::size_t kDecaying = Shape.decaying;
  static constexpr std::size_t kRotating = Shape.rotating;
  static constexpr std::size_t kInputs = Shape.inputs;
  static constexpr std::size_t kFirstInput = kDecaying + 2 * kRotating;
  static constexpr std::size_t kDrifts = kFirstInput + kInputs;
  using Drifts = std::array<float, kDrifts>;
  using ModeTransitions = TransitionOf<Shape>;
  using Transition = FilterTransition<Shape>;

  /// The drift that holds the real part of a rotating mode; the imaginary part is the next.
  static constexpr std::size_t rotating(std::size_t i) { return kDecaying + 2 * i; }

  /// Variances and covariances that noise adds over a span of ticks.
  struct Noise {
    float bias = 0.0F;  ///< added to the variance of the bias [rad2/s2]
    Drifts cross{};     ///< added to its covariances with the drifts
    Drifts drift{};     ///< added to the variances of the drifts
  };

  float tick_s;
  Gate gate;
  std::uint16_t confirmations;  ///< measurements that confirm the first one: those of a second
  std::array<float, kDecaying> decaying_alpha{};
  std::array<Complex, kRotating> rotating_alpha{};
  Drifts initial_variance{};
  Drifts initial_mean{};
  const InputBlock<Shape.inputs>* inputs;
  const HypothesesOf<Shape>* hypotheses;
  std::array<Noise, Shape.hypotheses> tick_noise;
  Forgetting<Shape> tick_forgetting;

  /// @param terms inputs of the bias; must outlive the coefficients
  /// @param guesses hypotheses of the slow noise; must outlive the coefficients
  constexpr explicit KalmanCoefficients(const ModesOf<Shape>& modes,
                                        const Gate& innovation_gate = {},
                                        const InputBlock<Shape.inputs>& terms = kNoInputs<Shape>,
                                        const HypothesesOf<Shape>& guesses = kKnownModel<Shape>)
      : tick_s(modes.tick.in_seconds()),
        gate(innovation_gate),
        confirmations(confirmations_at(modes.tick)),
        inputs(&terms),
        hypotheses(&guesses),
        tick_forgetting(forgetting_of(modes.one_tick())) {
    for (std::size_t i = 0; i < kDecaying; ++i) {
      const DecayingMode& mode = modes.decaying[i];
      decaying_alpha[i] = mode.one_minus_phi;
      initial_variance[i] = scale(i) * scale(i) * mode.initial_variance;
      initial_mean[i] = scale(i) * mode.initial_mean;
    }
    for (std::size_t i = 0; i < kRotating; ++i) {
      const RotatingMode& mode = modes.rotating[i];
      rotating_alpha[i] = mode.one_minus_phi;
      initial_variance[rotating(i)] = initial_variance[rotating(i) + 1] =
          squared_magnitude(rotating_scale(i)) * mode.initial_variance;
    }
    if constexpr (kInputs > 0) {
      for (std::size_t i = 0; i < kInputs; ++i) {
        const float sigma = terms.terms[i].sigma;
        initial_variance[kFirstInput + i] = sigma * sigma;
      }
    }
    for (std::size_t m = 0; m < Shape.hypotheses; ++m) {
      tick_noise[m] = noise_of(modes.one_tick(), m);
    }
  }

  /// Hypotheses that a filter weighs; 1 where the model is known.
  [[nodiscard]] constexpr std::size_t used_hypotheses() const {
    return std::max(std::size_t{1}, hypotheses->count);
  }
  /// Strengths of the modes under a hypothesis.
  [[nodiscard]] constexpr auto strength(std::size_t hypothesis) const {
    if constexpr (Shape.hypotheses == 1) {
      return AsModelled{};
    } else {
      return StrengthOf{*this, hypothesis};
    }
  }
  /// Expectation of the drifts of an axis before the first measurement.
  [[nodiscard]] constexpr Drifts initial_mean_of(std::size_t axis) const {
    Drifts mean = initial_mean;
    if constexpr (kInputs > 0) {
      for (std::size_t i = 0; i < kInputs; ++i) {
        mean[kFirstInput + i] = inputs->terms[i].coefficient[axis];
      }
    }
    return mean;
  }
  [[nodiscard]] constexpr float initial_variance_of(std::size_t hypothesis, std::size_t i) const {
    return i < kDecaying ? strength(hypothesis)[i] * initial_variance[i] : initial_variance[i];
  }

  /// Whether drift i belongs to a warm-up or a ramp: it starts with a mean or with more variance
  /// than its noise keeps up. Only a decaying mode can.
  [[nodiscard]] constexpr bool is_transient(std::size_t i) const {
    return initial_mean[i] != 0.0F ||
           tick_noise[0].drift[i] < 0.5F * decaying_alpha[i] * initial_variance_of(0, i);
  }
  /// Share of the bias that a drift of 1 stands for, if it ends with the drift: a ramp's stays.
  [[nodiscard]] constexpr float contribution(std::size_t i) const {
    return decaying_alpha[i] > kNearlyConstant ? -1.0F / decaying_alpha[i] : 0.0F;
  }

  [[nodiscard]] constexpr Noise noise_of(const ModeTransitions& span,
                                         std::size_t hypothesis) const {
    const auto of_mode = strength(hypothesis);
    Noise noise{.bias = span.noise(of_mode)};
    for (std::size_t i = 0; i < kDecaying; ++i) {
      noise.cross[i] = scale(i) * (of_mode[i] * span.decaying[i].noise);
      noise.drift[i] = scale(i) * scale(i) * (of_mode[i] * span.decaying[i].noise);
    }
    for (std::size_t i = 0; i < kRotating; ++i) {
      const Complex beta = rotating_scale(i);
      noise.cross[rotating(i)] = beta.re * span.rotating[i].noise;
      noise.cross[rotating(i) + 1] = beta.im * span.rotating[i].noise;
      noise.drift[rotating(i)] = noise.drift[rotating(i) + 1] =
          squared_magnitude(beta) * span.rotating[i].noise;
    }
    return noise;
  }
  [[nodiscard]] static constexpr Forgetting<Shape> forgetting_of(const ModeTransitions& span) {
    std::array<float, kDecaying> decaying{};
    std::array<Complex, kRotating> rotating{};
    for (std::size_t i = 0; i < kDecaying; ++i) decaying[i] = span.decaying[i].one_minus_phi_m;
    for (std::size_t i = 0; i < kRotating; ++i) rotating[i] = span.rotating[i].one_minus_phi_m;
    return {decaying, rotating};
  }

  /// F' w: weights of the drifts after a span, as weights of the drifts before it.
  [[nodiscard]] static constexpr Drifts forgotten_transposed(const ModeTransitions& span,
                                                             Drifts weight) {
    for (std::size_t i = 0; i < kDecaying; ++i) {
      weight[i] -= span.decaying[i].one_minus_phi_m * weight[i];
    }
    for (std::size_t i = 0; i < kRotating; ++i) {
      float& re = weight[rotating(i)];
      float& im = weight[rotating(i) + 1];
      const Complex forgotten = conjugate(span.rotating[i].one_minus_phi_m) * Complex{re, im};
      re -= forgotten.re;
      im -= forgotten.im;
    }
    return weight;
  }

  /// How far the bias moves over a span by each drift: (1 - F^m) / (1 - F), all ones for a tick;
  /// and by each coefficient: the change of its input.
  [[nodiscard]] static constexpr Drifts movement(const Transition& span) {
    Drifts weight{};
    for (std::size_t i = 0; i < kDecaying; ++i) {
      weight[i] = span.decaying[i].sum_gain + span.decaying[i].one_minus_phi_m;
    }
    for (std::size_t i = 0; i < kRotating; ++i) {
      set_rotating(weight, i, span.rotating[i].sum_gain + span.rotating[i].one_minus_phi_m);
    }
    if constexpr (kInputs > 0) set_inputs(weight, span.inputs.change);
    return weight;
  }
  /// Movement of the sum of the bias over the ticks of a span: sum_lag / alpha.
  [[nodiscard]] constexpr Drifts movement_of_sum(const Transition& span) const {
    Drifts weight{};
    for (std::size_t i = 0; i < kDecaying; ++i) {
      weight[i] = span.decaying[i].sum_lag / decaying_alpha[i];
    }
    for (std::size_t i = 0; i < kRotating; ++i) {
      const Complex over_square = Complex{1.0F / squared_magnitude(rotating_alpha[i])};
      set_rotating(weight, i,
                   span.rotating[i].sum_lag * conjugate(rotating_alpha[i]) * over_square);
    }
    if constexpr (kInputs > 0) set_inputs(weight, span.inputs.sum);
    return weight;
  }

 private:
  /// A filter with room for several hypotheses may use one.
  struct StrengthOf {
    const KalmanCoefficients& coefficients;
    std::size_t hypothesis;
    constexpr float operator[](std::size_t mode) const {
      const auto& guesses = *coefficients.hypotheses;
      return guesses.count == 0 ? 1.0F : guesses.all[hypothesis].strength[mode];
    }
  };

  static constexpr std::uint16_t confirmations_at(Duration tick) {
    constexpr std::int64_t kMost = 0xFFFE;
    return static_cast<std::uint16_t>(
        std::clamp(Duration::seconds(1) / tick, std::int64_t{1}, kMost));
  }

  /// beta.
  [[nodiscard]] constexpr float scale(std::size_t i) const { return -decaying_alpha[i]; }
  [[nodiscard]] constexpr Complex rotating_scale(std::size_t i) const {
    return Complex{-0.5F, -0.5F} * rotating_alpha[i];
  }

  static constexpr void set_inputs(Drifts& weight, const std::array<float, kInputs>& of_inputs) {
    for (std::size_t i = 0; i < kInputs; ++i) weight[kFirstInput + i] = of_inputs[i];
  }
  /// The bias moves by Re((1 - j) share w).
  static constexpr void set_rotating(Drifts& weight, std::size_t i, Complex share) {
    const Complex factor = Complex{1.0F, -1.0F} * share;
    weight[rotating(i)] = factor.re;
    weight[rotating(i) + 1] = -factor.im;
  }
};

template <std::size_t R, std::size_t C>
KalmanCoefficients(const Modes<R, C>&, const Gate& = {})
    -> KalmanCoefficients<ModelShape{.decaying = R, .rotating = C}>;

}  // namespace zerorate::core

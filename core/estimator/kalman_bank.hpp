/// @file
/// The Kalman predictor of a sensor's bias under level + modes (section IV-A of the paper, with one
/// state per decade instead of one per sample).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/unroll.hpp"
#include "core/estimator/kalman_coefficients.hpp"
#include "core/estimator/prediction.hpp"
#include "core/estimator/symmetric_matrix.hpp"

namespace zerorate::core {

/// Kalman filter of axes that are measured together, with the same noise: one covariance, and a
/// mean for each axis. A covariance depends on when and how exactly is measured, never on what
/// (docs/adr/0013). So a measurement that the gate takes for a knock is rejected on all axes.
///
/// The first state is the whole bias s = level + sum of the modes, not the level. A measurement
/// then sees one state (h = e_0), so an update needs no matrix product and cannot cancel: the
/// variance of s is multiplied by r / S. The diffuse start is exact, without a large number. The
/// other states are the drifts w of KalmanCoefficients: s' = s + sum of w + noise.
/// docs/design/kalman-predictor.md derives the equations, docs/adr/0006 and 0013 compare the forms.
///
/// Cost of a tick and its measurement at six decaying modes: 179 floating-point operations and one
/// division, and 35 operations an axis; no square root. Not re-entrant.
template <ModelShape Shape, std::size_t Axes>
class KalmanBank {
 public:
  using Coefficients = KalmanCoefficients<Shape>;
  using Transition = typename Coefficients::Transition;
  using Drifts = typename Coefficients::Drifts;
  using Rates = std::array<float, Axes>;
  using Innovations = std::array<Innovation, Axes>;
  static constexpr std::size_t kDrifts = Coefficients::kDrifts;
  static constexpr std::size_t kWeights = Coefficients::kWeights;
  static_assert(kDrifts > 0);

  /// Everything the filter remembers: plain data, may be stored and restored bit for bit.
  struct State {
    struct Axis {
      float reference_rad_s = 0.0F;     ///< the first measurement; all else is relative to it, so
                                        ///< that a large bias does not use up the mantissa
      float bias_rad_s = 0.0F;          ///< s
      float rejection_variance = 0.0F;  ///< doubt that rejected measurements add to Var s
      Drifts drift{};  ///< w [rad/s a tick]; behind those of the modes slope and curvature

      constexpr bool operator==(const Axis&) const = default;
    };

    static constexpr std::uint16_t kNotMeasured = 0xFFFF;
    std::uint16_t confirmations_left = kNotMeasured;  ///< measurements until the first is confirmed
    std::uint16_t rejected = 0;           ///< measurements since one was accepted (see Gate)
    float bias_variance = 0.0F;           ///< v = Var s [rad2/s2], if what was rejected were knocks
    Drifts bias_covariance{};             ///< p = Cov(s, w)
    SymmetricMatrix<kDrifts> covariance;  ///< W = Cov(w)
    std::array<Axis, Axes> axes{};

    constexpr bool operator==(const State&) const = default;
    [[nodiscard]] constexpr bool is_measured() const { return confirmations_left != kNotMeasured; }
    /// Nothing can contradict a first measurement but those that follow it: until they have for a
    /// second, it may have been anything.
    [[nodiscard]] constexpr bool is_confirmed() const { return confirmations_left == 0; }
  };
  static_assert(std::is_trivially_copyable_v<State>);

  /// Starts before the first measurement, with the modes at their initial variance.
  /// @param coefficients must outlive the filter
  constexpr explicit KalmanBank(const Coefficients& coefficients) : coefficients_(&coefficients) {
    for (std::size_t i = 0; i < kDrifts; ++i) {
      state_.covariance(i, i) = coefficients.initial_variance[i];
    }
    for (auto& axis : state_.axes) axis.drift = coefficients.initial_mean;
  }

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }

  /// Time passes. Call it before each measurement with the transition since the last.
  constexpr void advance(const Transition& span) {
    const Coefficients& a = *coefficients_;
    if (span.ticks == 0) return;
    if (span.ticks == 1) {
      advance_by(TickWeights{span}, a.tick_noise, a.tick_forgetting, span);
    } else {
      advance_by(SpanWeights{Coefficients::movement(span)}, a.noise_of(span),
                 Coefficients::forgetting_of(span), span);
    }
  }

  /// Learns from the mean measured rates of this tick [rad/s].
  /// @param white_variance of each [rad2/s2]
  /// @param unit of all variances of the state and of the predictions [rad2/s2 of the model's]: the
  ///   slow noise has so many times the variance that the model says
  constexpr Innovations observe(const Rates& rates_rad_s, float white_variance, float unit = 1.0F) {
    for (const float rate_rad_s : rates_rad_s) {
      if (!is_measurement(rate_rad_s, white_variance)) return {};
    }
    if (!state_.is_measured()) return observe_first(rates_rad_s, white_variance, unit);
    const float white = white_variance / unit;
    Innovations innovations{};
    for (std::size_t i = 0; i < Axes; ++i) {
      const Axis& axis = state_.axes[i];
      innovations[i] = {.accepted = true,
                        .residual_rad_s = (rates_rad_s[i] - axis.reference_rad_s) - axis.bias_rad_s,
                        .variance_rad2_s2 = (state_.bias_variance + white) * unit};
    }
    if (coefficients_->gate.is_on()) {
      const bool is_outlier =
          std::any_of(innovations.begin(), innovations.end(),
                      [&](const Innovation& one) { return coefficients_->gate.is_outlier(one); });
      // One of the two is wrong, and nobody knows which: the newer one must be confirmed now.
      if (is_outlier && !state_.is_confirmed()) {
        return observe_first(rates_rad_s, white_variance, unit);
      }
      if (is_knock(is_outlier, innovations, unit)) return innovations;
    }
    if (!state_.is_confirmed()) --state_.confirmations_left;
    update(innovations, white, unit);
    return innovations;
  }

  /// Adds the variance of an unseen change of the bias, in the unit of observe().
  constexpr void inflate_variance(float variance) { state_.bias_variance += variance; }

  /// Begins warm-up and ramp anew, each with another amplitude or slope: the sensor was switched on
  /// again. What the warm-up before has put on the bias is gone, what a ramp has put on it stays.
  /// docs/design/kalman-predictor.md, eq. 9b.
  constexpr void restart_transients() {
    for (std::size_t i = 0; i < Coefficients::kDecaying; ++i) {
      if (coefficients_->is_transient(i)) restart(i);
    }
  }

  /// Bias `lead` after the newest measurement; before the first, 0.
  [[nodiscard]] constexpr float bias_rad_s(const Transition& lead, std::size_t axis) const {
    if (!state_.is_measured()) return 0.0F;
    const typename State::Axis& x = state_.axes[axis];
    return x.reference_rad_s + (x.bias_rad_s + dot(Coefficients::movement(lead), x.drift));
  }
  /// Biases with their variances.
  [[nodiscard]] constexpr std::array<Prediction, Axes> predict(const Transition& lead) const {
    std::array<Prediction, Axes> predictions{};
    if (!state_.is_measured()) return predictions;
    const Drifts g = Coefficients::movement(lead);
    const float moved = 2.0F * dot(g, state_.bias_covariance) + quadratic(g);
    const float variance = state_.bias_variance + moved + lead.noise();
    for (std::size_t i = 0; i < Axes; ++i) {
      const typename State::Axis& x = state_.axes[i];
      predictions[i] = {x.reference_rad_s + (x.bias_rad_s + dot(g, x.drift)),
                        variance + x.rejection_variance + unknown_variance(lead, x)};
    }
    return predictions;
  }
  /// Integrals of the biases over `drive`, which begins `lead` after the newest measurement.
  [[nodiscard]] constexpr std::array<HeadingPrediction, Axes> predict_heading(
      const Transition& lead, const Transition& drive) const {
    if (!state_.is_measured()) return {};
    KalmanBank at_start = *this;
    at_start.advance(lead);
    return at_start.integrate(drive);
  }

 private:
  using Axis = typename State::Axis;

  /// Weights of a tick: a drift moves the bias by itself, without a multiplication; a constant of
  /// the temperature by the change of its weight.
  struct TickWeights {
    const Transition& span;
    [[nodiscard]] constexpr float weighted(std::size_t i, float x) const {
      if constexpr (kWeights > 0) {
        if (i >= Coefficients::kTemperature) {
          return span.temperature.change[i - Coefficients::kTemperature] * x;
        }
      }
      return x;
    }
  };
  struct SpanWeights {
    Drifts weights;
    [[nodiscard]] constexpr float weighted(std::size_t i, float x) const { return weights[i] * x; }
  };

  /// Eq. 7: s' = s + g'w, v' = v + g'(2 p + W g) + Q, p' = F (p + W g) + cross noise,
  /// W' = F W F' + noise.
  template <class Weights>
  constexpr void advance_by(const Weights& g, const typename Coefficients::Noise& noise,
                            const Forgetting<Shape>& forgetting, const Transition& span) {
    Drifts moved{};  // W g
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) {
      ZERORATE_UNROLLED for (std::size_t j = 0; j < i; ++j) {
        moved[i] += g.weighted(j, state_.covariance(i, j));
        moved[j] += g.weighted(i, state_.covariance(i, j));
      }
      moved[i] += g.weighted(i, state_.covariance(i, i));
    }
    const float cross = sum(g, state_.bias_covariance);
    state_.bias_variance = ((state_.bias_variance + noise.bias) + (cross + cross)) + sum(g, moved);
    if constexpr (kWeights > 0) state_.bias_variance += largest_unknown_variance(span);
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) state_.bias_covariance[i] +=
        moved[i];
    forgetting.apply(state_.bias_covariance);
    forgetting.apply(state_.covariance);
    ZERORATE_UNROLLED for (std::size_t i = 0; i < Coefficients::kTemperature; ++i) {
      state_.bias_covariance[i] += noise.cross[i];
      state_.covariance(i, i) += noise.drift[i];
    }
    for (Axis& axis : state_.axes) {
      axis.bias_rad_s += sum(g, axis.drift);
      forgetting.apply(axis.drift);
    }
  }

  /// Eq. 8: K = (v, p) / S; s += K_0 e, w += K e, v *= r / S, p *= r / S, W -= K p'.
  constexpr void update(const Innovations& innovations, float white, float unit) {
    const float inverse = unit / innovations[0].variance_rad2_s2;
    const float remaining = white * inverse;  // 1 - K_0, without the difference
    Drifts gain{};
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) gain[i] =
        state_.bias_covariance[i] * inverse;
    for (std::size_t k = 0; k < Axes; ++k) {
      Axis& axis = state_.axes[k];
      const float residual_rad_s = innovations[k].residual_rad_s;
      axis.bias_rad_s += state_.bias_variance * (residual_rad_s * inverse);
      ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) axis.drift[i] +=
          gain[i] * residual_rad_s;
    }
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) {
      ZERORATE_UNROLLED for (std::size_t j = 0; j <= i; ++j) {
        state_.covariance(i, j) -= gain[i] * state_.bias_covariance[j];
      }
    }
    for (float& p : state_.bias_covariance) p *= remaining;
    state_.bias_variance *= remaining;
  }

  constexpr Innovations observe_first(const Rates& rates_rad_s, float white_variance, float unit) {
    // A diffuse level: s is what was measured, and its error is independent of the modes.
    state_.confirmations_left = coefficients_->confirmations;
    state_.bias_variance = white_variance / unit;
    state_.bias_covariance = {};
    Innovations innovations{};
    for (std::size_t i = 0; i < Axes; ++i) {
      state_.axes[i].reference_rad_s = rates_rad_s[i];
      state_.axes[i].bias_rad_s = 0.0F;
      innovations[i] = {.accepted = true, .first = true, .variance_rad2_s2 = white_variance};
    }
    return innovations;
  }

  /// Keeps account of what the gate makes of a measurement; false where it is to be learnt from.
  constexpr bool is_knock(bool is_outlier, Innovations& innovations, float unit) {
    const Gate& gate = coefficients_->gate;
    const bool is_knock = is_outlier && state_.rejected < gate.longest_knock_ticks;
    state_.rejected = is_knock ? static_cast<std::uint16_t>(state_.rejected + 1) : std::uint16_t{0};
    float largest = 0.0F;
    for (std::size_t i = 0; i < Axes; ++i) {
      const float square = innovations[i].residual_rad_s * innovations[i].residual_rad_s;
      largest = std::max(largest, square);
      innovations[i].accepted = !is_knock;
      innovations[i].rejected = is_knock;
      state_.axes[i].rejection_variance =
          is_knock ? square / unit * static_cast<float>(state_.rejected) /
                         static_cast<float>(gate.longest_knock_ticks)
                   : 0.0F;
    }
    if (is_outlier && !is_knock) {  // it was a jump of this size
      state_.bias_variance += largest / unit;
      for (Innovation& innovation : innovations) innovation.variance_rad2_s2 += largest;
    }
    return is_knock;
  }

  /// Puts another drift in the place of drift i, independent of all that is known.
  constexpr void restart(std::size_t i) {
    State& x = state_;
    const float mean = coefficients_->initial_mean[i];
    const float variance = coefficients_->initial_variance[i];
    const float share = coefficients_->contribution(i);
    for (Axis& axis : x.axes) {
      axis.bias_rad_s += share * (mean - axis.drift[i]);
      axis.drift[i] = mean;
    }
    x.bias_variance +=
        share * (share * (x.covariance(i, i) + variance) - 2.0F * x.bias_covariance[i]);
    for (std::size_t j = 0; j < kDrifts; ++j) {
      x.bias_covariance[j] -= share * x.covariance(i, j);
      x.covariance(i, j) = 0.0F;
    }
    x.bias_covariance[i] = share * variance;
    x.covariance(i, i) = variance;
  }

  /// The sum of the bias over a drive that begins now, with its variance.
  [[nodiscard]] constexpr std::array<HeadingPrediction, Axes> integrate(
      const Transition& drive) const {
    const auto ticks = static_cast<float>(drive.ticks);
    const float tick_s = coefficients_->tick_s;
    const Drifts g = coefficients_->movement_of_sum(drive);
    const float variance =
        drive.sum_variance() + 2.0F * ticks * dot(g, state_.bias_covariance) + quadratic(g);
    std::array<HeadingPrediction, Axes> headings{};
    for (std::size_t i = 0; i < Axes; ++i) {
      const Axis& x = state_.axes[i];
      const float constant =
          state_.bias_variance + x.rejection_variance + unknown_variance(drive, x);
      headings[i] = {
          (ticks * x.reference_rad_s + (ticks * x.bias_rad_s + dot(g, x.drift))) * tick_s,
          (ticks * ticks * constant + variance) * tick_s * tick_s};
    }
    return headings;
  }

  /// Variance of the bias of an axis where the temperature was not known: the expectation of the
  /// square of (unknown change of the weights)' (constants).
  [[nodiscard]] constexpr float unknown_variance(const Transition& span, const Axis& axis) const {
    float variance = 0.0F;
    if constexpr (kWeights > 0) {
      const auto& u = span.temperature.unknown;
      constexpr std::size_t kFirst = Coefficients::kTemperature;
      for (std::size_t i = 0; i < kWeights; ++i) {
        for (std::size_t j = 0; j < kWeights; ++j) {
          variance += u[i] * u[j] *
                      (axis.drift[kFirst + i] * axis.drift[kFirst + j] +
                       state_.covariance(kFirst + i, kFirst + j));
        }
      }
    }
    return variance;
  }
  /// Unknown variance of the axis with the largest slope: no interval is too narrow.
  [[nodiscard]] constexpr float largest_unknown_variance(const Transition& span) const {
    float largest = 0.0F;
    for (const Axis& axis : state_.axes) largest = std::max(largest, unknown_variance(span, axis));
    return largest;
  }

  template <class Weights>
  [[nodiscard]] static constexpr float sum(const Weights& g, const Drifts& x) {
    float sum = g.weighted(0, x[0]);
    ZERORATE_UNROLLED for (std::size_t i = 1; i < kDrifts; ++i) sum += g.weighted(i, x[i]);
    return sum;
  }
  [[nodiscard]] static constexpr float dot(const Drifts& a, const Drifts& b) {
    return sum(SpanWeights{a}, b);
  }
  /// g' W g.
  [[nodiscard]] constexpr float quadratic(const Drifts& g) const {
    float sum = 0.0F;
    for (std::size_t i = 0; i < kDrifts; ++i) {
      float row = 0.5F * state_.covariance(i, i) * g[i];
      for (std::size_t j = 0; j < i; ++j) row += state_.covariance(i, j) * g[j];
      sum += row * g[i];
    }
    return sum + sum;
  }

  const Coefficients* coefficients_;
  State state_{};
};

/// The promise of the product page: six decades and the bias of three axes fit into 224 bytes.
static_assert(sizeof(KalmanBank<ModelShape{.decaying = 6}, 3>::State) <= 224);

}  // namespace zerorate::core

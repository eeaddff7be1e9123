/// @file
/// The Kalman predictor of a gyro's bias under level + modes (the paper's section IV-A with one
/// state per decade instead of one per sample).
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "core/estimator/prediction.hpp"
#include "core/estimator/symmetric.hpp"
#include "core/noise/modes.hpp"

namespace zerorate::core {

/// Kalman filter of one axis with R decaying and C rotating modes; N = R + 2 C.
///
/// The first state is the whole bias s = level + sum of the modes, not the level. A measurement
/// then sees one state (h = e_0), so an update needs no matrix product and cannot cancel: the
/// variance of s is multiplied by r / S. The diffuse start is exact, without a large number. With
/// g_j = Re(F_j - 1) the bias moves by s' = s + g'z + noise. docs/design/kalman-predictor.md
/// derives it, docs/adr/0006 compares it with the other forms.
///
/// Cost per tick at R = 6, C = 0: about 340 floating-point operations and one division; stack
/// below 150 bytes; no square root. Not re-entrant; one instance per axis.
template <std::size_t R, std::size_t C>
class KalmanPredictor {
 public:
  static constexpr std::size_t N = R + 2 * C;
  using Span = Transition<R, C>;

  /// Everything the filter remembers: plain data, may be stored and restored bit for bit.
  struct State {
    bool calibrated = false;       ///< a first measurement has been seen
    float reference_rad_s = 0.0F;  ///< the first measurement; all else is relative to it, so that a
                                   ///< large bias does not use up the mantissa
    float bias_rad_s = 0.0F;       ///< s
    float bias_variance = 0.0F;    ///< Var s [rad2/s2]
    std::array<float, N> z{};      ///< the modes [rad/s], decaying first
    std::array<float, N> bias_covariance{};  ///< p = Cov(s, z)
    Symmetric<N> covariance{};               ///< Z = Cov(z)
  };
  static_assert(std::is_trivially_copyable_v<State>);

  /// Starts before the first measurement, with the modes at their initial variance.
  constexpr explicit KalmanPredictor(const Modes<R, C>& modes) {
    for (std::size_t i = 0; i < R; ++i) {
      state_.covariance(i, i) = modes.decaying[i].initial_variance;
    }
    for (std::size_t i = R; i < N; ++i) {
      state_.covariance(i, i) = modes.rotating[(i - R) / 2].initial_variance;
    }
    tick_s_ = modes.tick.in_seconds();
  }

  [[nodiscard]] constexpr const State& state() const { return state_; }
  constexpr void restore(const State& state) { state_ = state; }

  /// The filter remembers across stops: nothing to do.
  constexpr void begin_stop() {}

  constexpr void advance(const Span& span) {
    const Moved moved = move_bias(span);
    state_.bias_rad_s = moved.bias_rad_s;
    state_.bias_variance = moved.variance;
    for (std::size_t i = 0; i < N; ++i) state_.bias_covariance[i] += moved.cross[i];
    apply_factors(span, state_.z);
    apply_factors(span, state_.bias_covariance);
    for (std::size_t i = 0; i < R; ++i) state_.bias_covariance[i] += span.decaying[i].noise;
    for (std::size_t i = 0; i < C; ++i) {
      state_.bias_covariance[R + 2 * i] += span.rotating[i].noise;
    }
    advance_covariance(span);
  }

  constexpr Innovation observe(float rate_rad_s, float white_variance) {
    if (!is_measurement(rate_rad_s, white_variance)) return {};
    if (!state_.calibrated) return observe_first(rate_rad_s, white_variance);
    State& x = state_;
    const Innovation innovation{.accepted = true,
                                .residual_rad_s = (rate_rad_s - x.reference_rad_s) - x.bias_rad_s,
                                .variance_rad2_s2 = x.bias_variance + white_variance};
    const float inverse_variance = 1.0F / innovation.variance_rad2_s2;
    const float weighted_residual = innovation.residual_rad_s * inverse_variance;
    std::array<float, N> gain;
    for (std::size_t i = 0; i < N; ++i) gain[i] = x.bias_covariance[i] * inverse_variance;

    x.bias_rad_s += x.bias_variance * weighted_residual;
    for (std::size_t i = 0; i < N; ++i) x.z[i] += x.bias_covariance[i] * weighted_residual;
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j <= i; ++j) x.covariance(i, j) -= gain[i] * x.bias_covariance[j];
    }
    const float remaining = white_variance * inverse_variance;  // 1 - K_0, without the difference
    x.bias_variance *= remaining;
    for (float& p : x.bias_covariance) p *= remaining;
    return innovation;
  }

  [[nodiscard]] constexpr float bias_rad_s(const Span& lead) const {
    if (!state_.calibrated) return 0.0F;
    const auto g = weights(lead, &ModeSpan<float>::forgotten, &ModeSpan<Complex>::forgotten);
    return state_.reference_rad_s + moved_bias(g);
  }

  [[nodiscard]] constexpr Prediction predict(const Span& lead) const {
    if (!state_.calibrated) return {};
    const Moved moved = move_bias(lead);
    return {state_.reference_rad_s + moved.bias_rad_s, moved.variance};
  }

  [[nodiscard]] constexpr HeadingPrediction predict_heading(const Span& lead,
                                                            const Span& drive) const {
    if (!state_.calibrated) return {};
    KalmanPredictor at_start = *this;
    at_start.advance(lead);
    return at_start.integrate(drive);
  }

 private:
  /// The bias after a span, and what the span adds to Cov(s, z) before the factors apply.
  struct Moved {
    float bias_rad_s;
    float variance;
    std::array<float, N> cross;  ///< Z g
  };

  constexpr Innovation observe_first(float rate_rad_s, float white_variance) {
    // A diffuse level: s is what was measured, and its error is independent of the modes.
    state_.calibrated = true;
    state_.reference_rad_s = rate_rad_s;
    state_.bias_rad_s = 0.0F;
    state_.bias_variance = white_variance;
    state_.bias_covariance = {};
    return {.accepted = true, .first = true, .variance_rad2_s2 = white_variance};
  }

  [[nodiscard]] constexpr Moved move_bias(const Span& span) const {
    const State& x = state_;
    const auto g = weights(span, &ModeSpan<float>::forgotten, &ModeSpan<Complex>::forgotten);
    Moved moved{moved_bias(g), 0.0F, times_covariance(g)};
    float gained = 0.0F;
    for (std::size_t i = 0; i < N; ++i) {
      gained += g[i] * (2.0F * x.bias_covariance[i] + moved.cross[i]);
    }
    moved.variance = (x.bias_variance + gained) + span.noise();
    return moved;
  }

  [[nodiscard]] constexpr float moved_bias(const std::array<float, N>& g) const {
    float bias = state_.bias_rad_s;
    for (std::size_t i = 0; i < N; ++i) bias += g[i] * state_.z[i];
    return bias;
  }

  /// The sum of the bias over a drive that begins now, with its variance.
  [[nodiscard]] constexpr HeadingPrediction integrate(const Span& drive) const {
    const State& x = state_;
    const auto ticks = static_cast<float>(drive.ticks);
    const auto g = weights(drive, &ModeSpan<float>::lag, &ModeSpan<Complex>::lag);
    const auto cross = times_covariance(g);
    float sum = ticks * x.bias_rad_s;
    float variance = ticks * ticks * x.bias_variance + drive.sum_variance();
    for (std::size_t i = 0; i < N; ++i) {
      sum += g[i] * x.z[i];
      variance += g[i] * (2.0F * ticks * x.bias_covariance[i] + cross[i]);
    }
    return {(ticks * x.reference_rad_s + sum) * tick_s_, variance * tick_s_ * tick_s_};
  }

  /// How the bias (or its sum) depends on the modes: minus Re(share z), share by share.
  [[nodiscard]] static constexpr std::array<float, N> weights(
      const Span& span, float ModeSpan<float>::*decaying, Complex ModeSpan<Complex>::*rotating) {
    std::array<float, N> g{};
    for (std::size_t i = 0; i < R; ++i) g[i] = -(span.decaying[i].*decaying);
    for (std::size_t i = 0; i < C; ++i) {
      g[R + 2 * i] = -(span.rotating[i].*rotating).re;
      g[R + 2 * i + 1] = (span.rotating[i].*rotating).im;
    }
    return g;
  }

  [[nodiscard]] constexpr std::array<float, N> times_covariance(
      const std::array<float, N>& g) const {
    std::array<float, N> product{};
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j < N; ++j) product[i] += state_.covariance(i, j) * g[j];
    }
    return product;
  }

  /// v = F v; slow modes lose a small share of themselves, so the share is subtracted.
  static constexpr void apply_factors(const Span& span, std::array<float, N>& v) {
    for (std::size_t i = 0; i < R; ++i) v[i] -= span.decaying[i].forgotten * v[i];
    for (std::size_t i = 0; i < C; ++i) {
      float& re = v[R + 2 * i];
      float& im = v[R + 2 * i + 1];
      const Complex lost = span.rotating[i].forgotten * Complex{re, im};
      re -= lost.re;
      im -= lost.im;
    }
  }

  /// Z = F Z F' + Q.
  constexpr void advance_covariance(const Span& span) {
    Symmetric<N>& covariance = state_.covariance;
    for (std::size_t i = 0; i < R; ++i) {
      const float a = span.decaying[i].forgotten;
      for (std::size_t j = 0; j <= i; ++j) {
        const float b = span.decaying[j].forgotten;
        covariance(i, j) -= (a + b - a * b) * covariance(i, j);
      }
      covariance(i, i) += span.decaying[i].noise;
    }
    if constexpr (C > 0) advance_rotating_rows(span);
  }

  /// The rows of the rotating modes: each is a vector to which F applies from the right, and each
  /// pair of rows is then turned from the left.
  constexpr void advance_rotating_rows(const Span& span) {
    std::array<std::array<float, N>, 2 * C> rows{};
    for (std::size_t i = 0; i < 2 * C; ++i) {
      for (std::size_t j = 0; j < N; ++j) rows[i][j] = state_.covariance(R + i, j);
      apply_factors(span, rows[i]);
    }
    for (std::size_t i = 0; i < C; ++i) {
      for (std::size_t j = 0; j <= R + 2 * i + 1; ++j) {
        const Complex pair{rows[2 * i][j], rows[2 * i + 1][j]};
        const Complex turned = pair - span.rotating[i].forgotten * pair;
        state_.covariance(R + 2 * i, j) = turned.re;
        state_.covariance(R + 2 * i + 1, j) = turned.im;
      }
      state_.covariance(R + 2 * i, R + 2 * i) += span.rotating[i].noise;
      state_.covariance(R + 2 * i + 1, R + 2 * i + 1) += span.rotating[i].noise;
    }
  }

  State state_{};
  float tick_s_ = 0.0F;
};

/// The promise of the product page: six decades and the bias fit into 192 bytes an axis.
static_assert(sizeof(KalmanPredictor<6, 0>::State) <= 192);

}  // namespace zerorate::core

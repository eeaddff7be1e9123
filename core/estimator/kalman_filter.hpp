/// @file
/// The recursion of the Kalman predictor (section IV-A of the paper, with one state per decade
/// instead of one per sample).
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "core/base/compile_time.hpp"
#include "core/base/numeric.hpp"
#include "core/base/symmetric_matrix.hpp"
#include "core/estimator/kalman_coefficients.hpp"

namespace zerorate::core {

/// Kalman filter of axes that are measured together, with the same noise: one covariance, and a
/// mean for each axis. A covariance depends on when and how exactly is measured, never on what
/// (docs/adr/0013).
///
/// The first state is the whole bias s = level + sum of the modes, not the level. A measurement
/// then sees one state (h = e_0), so an update needs no matrix product and cannot cancel: the
/// variance of s is multiplied by r / S. The diffuse start is exact, without a large number. The
/// other states are the drifts w of KalmanCoefficients: s' = s + sum of w + noise.
/// docs/design/kalman-predictor.md derives the equations, docs/adr/0006 and 0013 compare the forms.
///
/// Plain data: may be stored and restored bit for bit. Cost of a tick and its measurement at six
/// decaying modes: 179 floating-point operations and one division, and 35 operations an axis.
template <ModelShape Shape, std::size_t Axes>
struct KalmanFilter {
  using Coefficients = KalmanCoefficients<Shape>;
  using Transition = typename Coefficients::Transition;
  using Drifts = typename Coefficients::Drifts;
  using Noise = typename Coefficients::Noise;
  using Residuals = std::array<float, Axes>;
  static constexpr std::size_t kDrifts = Coefficients::kDrifts;
  static constexpr std::size_t kInputs = Coefficients::kInputs;
  static_assert(kDrifts > 0);

  struct Axis {
    float bias_rad_s = 0.0F;  ///< s, relative to the first measurement
    Drifts drift{};           ///< w [rad/s a tick]; behind those of the modes the coefficients

    constexpr bool operator==(const Axis&) const = default;
  };

  float bias_variance = 0.0F;           ///< v = Var s [rad2/s2]
  Drifts bias_covariance{};             ///< p = Cov(s, w)
  SymmetricMatrix<kDrifts> covariance;  ///< W = Cov(w)
  std::array<Axis, Axes> axes{};

  constexpr bool operator==(const KalmanFilter&) const = default;

  /// Weights of a tick: a drift moves the bias by itself, without a multiplication; a coefficient
  /// by the change of its input.
  struct TickWeights {
    const Transition& span;
    [[nodiscard]] constexpr float weighted(std::size_t i, float x) const {
      if constexpr (kInputs > 0) {
        if (i >= Coefficients::kFirstInput) {
          return span.inputs.change[i - Coefficients::kFirstInput] * x;
        }
      }
      return x;
    }
  };
  struct SpanWeights {
    Drifts weights;
    [[nodiscard]] constexpr float weighted(std::size_t i, float x) const { return weights[i] * x; }
  };

  /// The modes before the first measurement.
  constexpr void start(const Coefficients& coefficients, std::size_t hypothesis) {
    for (std::size_t i = 0; i < kDrifts; ++i) {
      covariance(i, i) = coefficients.initial_variance_of(hypothesis, i);
    }
    for (std::size_t k = 0; k < Axes; ++k) axes[k].drift = coefficients.initial_mean_of(k);
  }

  /// Eq. 7: s' = s + g'w, v' = v + g'(2 p + W g) + Q, p' = F (p + W g) + cross noise,
  /// W' = F W F' + noise.
  template <class Weights>
  constexpr void advance(const Weights& g, const Noise& noise,
                         const Forgetting<Shape>& forgetting) {
    Drifts moved{};  // W g
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) {
      ZERORATE_UNROLLED for (std::size_t j = 0; j < i; ++j) {
        moved[i] += g.weighted(j, covariance(i, j));
        moved[j] += g.weighted(i, covariance(i, j));
      }
      moved[i] += g.weighted(i, covariance(i, i));
    }
    const float cross = sum(g, bias_covariance);
    bias_variance = ((bias_variance + noise.bias) + (cross + cross)) + sum(g, moved);
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) bias_covariance[i] += moved[i];
    forgetting.apply(bias_covariance);
    forgetting.apply(covariance);
    ZERORATE_UNROLLED for (std::size_t i = 0; i < Coefficients::kFirstInput; ++i) {
      bias_covariance[i] += noise.cross[i];
      covariance(i, i) += noise.drift[i];
    }
    for (Axis& axis : axes) {
      axis.bias_rad_s += sum(g, axis.drift);
      forgetting.apply(axis.drift);
    }
  }

  /// A first measurement. The level is diffuse: s is what was measured, and its error is
  /// independent of the modes.
  constexpr void observe_first(float white_variance) {
    bias_variance = white_variance;
    bias_covariance = {};
    for (Axis& axis : axes) axis.bias_rad_s = 0.0F;
  }

  /// Eq. 8: K = (v, p) / S; s += K_0 e, w += K e, v *= r / S, p *= r / S, W -= K p'.
  constexpr void update(const Residuals& residuals_rad_s, float white_variance) {
    const float inverse = 1.0F / (bias_variance + white_variance);
    const float remaining = white_variance * inverse;  // 1 - K_0, without the difference
    Drifts gain{};
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) gain[i] =
        bias_covariance[i] * inverse;
    for (std::size_t k = 0; k < Axes; ++k) {
      Axis& axis = axes[k];
      const float residual_rad_s = residuals_rad_s[k];
      axis.bias_rad_s += bias_variance * (residual_rad_s * inverse);
      ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) axis.drift[i] +=
          gain[i] * residual_rad_s;
    }
    ZERORATE_UNROLLED for (std::size_t i = 0; i < kDrifts; ++i) {
      ZERORATE_UNROLLED for (std::size_t j = 0; j <= i; ++j) {
        covariance(i, j) -= gain[i] * bias_covariance[j];
      }
    }
    for (float& p : bias_covariance) p *= remaining;
    bias_variance *= remaining;
  }

  /// The unit of the variances is larger by this factor than was assumed. What is known of the
  /// inputs is no noise, and stays.
  constexpr void change_unit(float factor) {
    const float per_root = 1.0F / square_root(factor);
    const float per_unit = 1.0F / factor;
    for (std::size_t i = Coefficients::kFirstInput; i < kDrifts; ++i) {
      bias_covariance[i] *= per_root;
      for (std::size_t j = 0; j < Coefficients::kFirstInput; ++j) covariance(i, j) *= per_root;
      for (std::size_t j = Coefficients::kFirstInput; j <= i; ++j) covariance(i, j) *= per_unit;
    }
  }

  /// Puts another drift in the place of drift i, independent of all that is known.
  constexpr void restart(const Coefficients& coefficients, std::size_t hypothesis, std::size_t i) {
    const float mean = coefficients.initial_mean[i];
    const float variance = coefficients.initial_variance_of(hypothesis, i);
    const float share = coefficients.contribution(i);
    for (Axis& axis : axes) {
      axis.bias_rad_s += share * (mean - axis.drift[i]);
      axis.drift[i] = mean;
    }
    bias_variance += share * (share * (covariance(i, i) + variance) - 2.0F * bias_covariance[i]);
    for (std::size_t j = 0; j < kDrifts; ++j) {
      bias_covariance[j] -= share * covariance(i, j);
      covariance(i, j) = 0.0F;
    }
    bias_covariance[i] = share * variance;
    covariance(i, i) = variance;
  }

  /// How far the bias moves by its drifts over a span with these weights.
  [[nodiscard]] constexpr float moved(const Drifts& g, std::size_t axis) const {
    return dot(g, axes[axis].drift);
  }
  /// Variance of x s + g'w, without that of x s.
  [[nodiscard]] constexpr float moved_variance(float x, const Drifts& g) const {
    return 2.0F * x * dot(g, bias_covariance) + quadratic(g);
  }

  /// Variance of the bias after a span by the doubt in the coefficients of the inputs alone.
  [[nodiscard]] constexpr float input_variance(const Transition& span) const {
    float variance = 0.0F;
    if constexpr (kInputs > 0) {
      constexpr std::size_t kFirst = Coefficients::kFirstInput;
      const auto& change = span.inputs.change;
      for (std::size_t i = 0; i < kInputs; ++i) {
        for (std::size_t j = 0; j < kInputs; ++j) {
          variance += change[i] * change[j] * covariance(kFirst + i, kFirst + j);
        }
      }
    }
    return variance;
  }

  /// Variance of the bias of an axis where inputs were not known: the expectation of the square of
  /// (unknown change of the inputs)' (coefficients).
  /// @param scale of the covariance
  [[nodiscard]] constexpr float unknown_variance([[maybe_unused]] const Coefficients& coefficients,
                                                 [[maybe_unused]] const Transition& span,
                                                 [[maybe_unused]] std::size_t axis,
                                                 [[maybe_unused]] float scale) const {
    if constexpr (kInputs > 0) {
      if (!span.inputs.is_known()) {
        return variance_of(span.inputs.unknown, coefficients, axes[axis].drift, scale);
      }
    }
    return 0.0F;
  }

 private:
  /// Not inlined: it is rare, and a board counts its stack.
  template <class Unknown>
  [[nodiscard, gnu::noinline]] constexpr float variance_of(const Unknown& unknown,
                                                           const Coefficients& coefficients,
                                                           const Drifts& drift, float scale) const {
    constexpr std::size_t kFirst = Coefficients::kFirstInput;
    const auto& terms = coefficients.inputs->terms;
    float variance = 0.0F;
    for (std::size_t i = 0; i < kInputs; ++i) {
      for (std::size_t j = 0; j < kInputs; ++j) {
        if (!change_together(terms[i].input, terms[j].input)) continue;
        variance +=
            unknown[i] * unknown[j] *
            (drift[kFirst + i] * drift[kFirst + j] + scale * covariance(kFirst + i, kFirst + j));
      }
    }
    return variance;
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
      float row = 0.5F * covariance(i, i) * g[i];
      for (std::size_t j = 0; j < i; ++j) row += covariance(i, j) * g[j];
      sum += row * g[i];
    }
    return sum + sum;
  }
};

}  // namespace zerorate::core

/// @file
/// A mode, the smallest piece of slow noise, and its transition over a span of ticks.
///
/// Every noise block of the project is a sum of modes. With F the mode's one-tick factor,
///
///     z[k+1] = F z[k] + w[k],   contribution to the bias: Re z,
///
/// F = phi real for a decaying mode (first-order Gauss-Markov), F = rho exp(i theta) for a rotating
/// one (damped oscillation; w circular). docs/design/noise-modes.md derives what follows.
#pragma once

#include <cstdint>

#include "core/base/complex.hpp"

namespace zerorate::core {

/// 1 - F of a mode that moves steadily and does not decay (RateRamp).
inline constexpr float kNearlyConstant = 0x1p-40F;

/// One mode at the filter's tick.
/// @tparam Scalar float for a decaying mode, Complex for a rotating one
template <class Scalar>
struct Mode {
  /// alpha = 1 - F, stored because F of a slow mode rounds to 1. Never 0: that would be a walk of
  /// the level.
  Scalar one_minus_phi{1.0F};
  /// Variance of Re w per tick [rad2/s2].
  float noise_variance = 0.0F;
  /// Variance of Re z when the filter starts [rad2/s2]: 0, or the stationary one.
  float initial_variance = 0.0F;
  /// Expectation of Re z when the filter starts [rad/s].
  float initial_mean = 0.0F;

  constexpr bool operator==(const Mode&) const = default;
};

using DecayingMode = Mode<float>;
using RotatingMode = Mode<Complex>;

/// Transition of a mode over m ticks, from z before the span to z' after it and to the running sum
/// Z = z[1] + ... + z[m]:
///
///     z' = (1 - one_minus_phi_m) z + n,   Z = (m - sum_lag) z + N,   Var Re n = noise,
///     E[N conj(n)] / 2 = sum_covariance,   Var Re N = sum_variance.
///
/// No member is a difference of nearly equal numbers; all terms of a decaying mode are
/// positive, so that single precision holds over any span.
template <class Scalar>
struct ModeTransition {
  Scalar one_minus_phi_m{};
  Scalar sum_lag{};   ///< sum over k = 1..m of (1 - F^k)
  Scalar sum_gain{};  ///< m - sum_lag, accumulated separately: for fast modes the difference is
                      ///< nothing
  Scalar sum_covariance{};
  float noise = 0.0F;
  float sum_variance = 0.0F;

  constexpr bool operator==(const ModeTransition&) const = default;
};

/// The span of a single tick.
template <class Scalar>
[[nodiscard]] constexpr ModeTransition<Scalar> one_tick(const Mode<Scalar>& mode) {
  return {.one_minus_phi_m = mode.one_minus_phi,
          .sum_lag = mode.one_minus_phi,
          .sum_gain = Scalar{1.0F} - mode.one_minus_phi,
          .sum_covariance = Scalar{mode.noise_variance},
          .noise = mode.noise_variance,
          .sum_variance = mode.noise_variance};
}

/// The span `first` followed by the span `second` of the same mode.
/// @param second_ticks the length of `second`
template <class Scalar>
[[nodiscard]] constexpr ModeTransition<Scalar> then(const ModeTransition<Scalar>& first,
                                                    const ModeTransition<Scalar>& second,
                                                    std::uint32_t second_ticks) {
  const Scalar kept_first = Scalar{1.0F} - first.one_minus_phi_m;
  const Scalar kept_second = Scalar{1.0F} - second.one_minus_phi_m;
  const auto ticks = static_cast<float>(second_ticks);
  return {.one_minus_phi_m = first.one_minus_phi_m + kept_first * second.one_minus_phi_m,
          .sum_lag = first.sum_lag + ticks * first.one_minus_phi_m + kept_first * second.sum_lag,
          .sum_gain = first.sum_gain + kept_first * second.sum_gain,
          .sum_covariance = conjugate(kept_second) * first.sum_covariance +
                            conjugate(kept_second) * second.sum_gain * first.noise +
                            second.sum_covariance,
          .noise = squared_magnitude(kept_second) * first.noise + second.noise,
          .sum_variance = first.sum_variance +
                          2.0F * real_part(conjugate(second.sum_gain) * first.sum_covariance) +
                          squared_magnitude(second.sum_gain) * first.noise + second.sum_variance};
}

/// The span of any number of ticks, by repeated doubling: at most 2 log2(ticks) compositions.
template <class Scalar>
[[nodiscard]] constexpr ModeTransition<Scalar> over(const Mode<Scalar>& mode, std::uint32_t ticks) {
  ModeTransition<Scalar> result{};
  ModeTransition<Scalar> power = one_tick(mode);
  for (std::uint32_t power_ticks = 1;; power_ticks *= 2) {
    if ((ticks & 1U) != 0) result = then(result, power, power_ticks);
    ticks >>= 1U;
    if (ticks == 0) return result;
    power = then(power, power, power_ticks);
  }
}

/// Variance of Re z after the span, given the variance before it.
template <class Scalar>
[[nodiscard]] constexpr float variance_after(const ModeTransition<Scalar>& span, float variance) {
  return squared_magnitude(Scalar{1.0F} - span.one_minus_phi_m) * variance + span.noise;
}

}  // namespace zerorate::core

/// @file
/// Terms of a sensor's noise model, and the modes by which a filter follows each.
#pragma once

#include <array>
#include <cstddef>
#include <numbers>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/noise/modes.hpp"

namespace zerorate::core {

/// White noise of the measured rate (angle random walk): no state, the variance of a measurement.
struct White {
  float angle_random_walk_rad_sqrt_s = 0.0F;  ///< N of IEEE Std 952 [rad/s/sqrt(Hz) = rad/sqrt(s)]

  /// Variance of the mean over an averaging time [rad2/s2].
  [[nodiscard]] constexpr float variance(Duration averaging_time) const {
    return angle_random_walk_rad_sqrt_s * angle_random_walk_rad_sqrt_s /
           averaging_time.in_seconds();
  }
};

/// Rate random walk (RRW) of the bias: it costs no state, because it drives the level itself.
struct RandomWalk {
  static constexpr std::size_t kDecaying = 0;
  static constexpr std::size_t kRotating = 0;

  float coefficient_rad_s_sqrt_s = 0.0F;  ///< K of IEEE Std 952: variance K^2 t after time t

  template <std::size_t R, std::size_t C>
  constexpr void contribute(Duration tick, ModeWriter<R, C>& writer) const {
    writer.add_walk(coefficient_rad_s_sqrt_s * coefficient_rad_s_sqrt_s * tick.in_seconds());
  }
};

/// Flicker noise, 1/f^(2d) (bias instability), compressed to one state per decade (Keshner 1982);
/// the paper's section IV-A names the idea. Time constants and variances come from a spectral fit
/// (firmware/model, flicker_fit) and are plain constants on the target.
/// @tparam N number of decades
template <std::size_t N>
struct FlickerDecades {
  static constexpr std::size_t kDecaying = N;
  static constexpr std::size_t kRotating = 0;

  std::array<float, N> time_constant_s{};
  std::array<float, N> variance_rad2_s2{};  ///< stationary variance of each decade

  template <std::size_t R, std::size_t C>
  constexpr void contribute(Duration tick, ModeWriter<R, C>& writer) const {
    for (std::size_t i = 0; i < N; ++i) {
      const float elapsed = tick.in_seconds() / time_constant_s[i];
      writer.add(one_minus_exp_neg(elapsed),
                 variance_rad2_s2[i] * one_minus_exp_neg(2.0F * elapsed), variance_rad2_s2[i]);
    }
  }
};

/// First-order Gauss-Markov noise (exponentially correlated).
struct GaussMarkov {
  static constexpr std::size_t kDecaying = 1;
  static constexpr std::size_t kRotating = 0;

  float sigma_rad_s = 0.0F;  ///< stationary standard deviation
  float time_constant_s = 1.0F;

  template <std::size_t R, std::size_t C>
  constexpr void contribute(Duration tick, ModeWriter<R, C>& writer) const {
    const float elapsed = tick.in_seconds() / time_constant_s;
    const float variance = sigma_rad_s * sigma_rad_s;
    writer.add(one_minus_exp_neg(elapsed), variance * one_minus_exp_neg(2.0F * elapsed), variance);
  }
};

/// Disturbance near one frequency, whose phase wanders: a damped rotation driven by noise.
struct Harmonic {
  static constexpr std::size_t kDecaying = 0;
  static constexpr std::size_t kRotating = 1;

  float rms_rad_s = 0.0F;         ///< stationary standard deviation of the contribution
  float frequency_hz = 0.0F;      ///< larger than the Nyquist frequency of the tick: aliased
  float coherence_time_s = 1.0F;  ///< larger: narrower line

  template <std::size_t R, std::size_t C>
  constexpr void contribute(Duration tick, ModeWriter<R, C>& writer) const {
    const float elapsed = tick.in_seconds() / coherence_time_s;
    const float turns = frequency_hz * tick.in_seconds();
    const float phase = 2.0F * std::numbers::pi_v<float> * (turns - nearest_integer(turns));
    const float variance = rms_rad_s * rms_rad_s;
    // F = exp(-elapsed + i phase), hence 1 - F = one_minus_exp_neg(elapsed - i phase).
    writer.add(one_minus_exp_neg(Complex{elapsed, -phase}),
               variance * one_minus_exp_neg(2.0F * elapsed), variance);
  }
};

/// Transient after power-on: amplitude exp(-t / time_constant), t since the filter's start; the
/// amplitude differs from start to start. A decaying mode with nothing that drives it.
struct WarmUp {
  static constexpr std::size_t kDecaying = 1;
  static constexpr std::size_t kRotating = 0;

  float amplitude_rad_s = 0.0F;  ///< expected
  float sigma_rad_s = 0.0F;      ///< standard deviation of the amplitude
  float time_constant_s = 1.0F;

  template <std::size_t R, std::size_t C>
  constexpr void contribute(Duration tick, ModeWriter<R, C>& writer) const {
    const float elapsed = tick.in_seconds() / time_constant_s;
    const float variance = sigma_rad_s * sigma_rad_s;
    // A number that decays without end becomes subnormal, and processors are slow with those. So
    // the variance never falls below this share of the first one, far below any measurement.
    constexpr float kFloor = 1e-12F;
    writer.add_transient(one_minus_exp_neg(elapsed),
                         kFloor * variance * one_minus_exp_neg(2.0F * elapsed), amplitude_rad_s,
                         variance);
  }
};

/// Bias that moves steadily: slope t, t since the filter's start. The slope differs from start to
/// start; a new one continues from the last bias. It is the beginning of a decay with a time
/// constant of 2^40 ticks (350 years at 100 Hz). A predictor that holds drifts stores the slope
/// itself, so that nothing large enters its arithmetic.
struct RateRamp {
  static constexpr std::size_t kDecaying = 1;
  static constexpr std::size_t kRotating = 0;

  float slope_rad_s2 = 0.0F;  ///< expected
  float sigma_rad_s2 = 0.0F;  ///< standard deviation of the slope

  template <std::size_t R, std::size_t C>
  constexpr void contribute(Duration tick, ModeWriter<R, C>& writer) const {
    const float ticks_s = tick.in_seconds() / kNearlyConstant;
    const float sigma_rad_s = sigma_rad_s2 * ticks_s;
    writer.add_transient(kNearlyConstant, 0.0F, -slope_rad_s2 * ticks_s, sigma_rad_s * sigma_rad_s);
  }
};

}  // namespace zerorate::core

/// @file
/// A disturbance near one frequency, whose phase wanders: a damped rotation driven by noise.
#pragma once

#include <cstddef>
#include <numbers>

#include "core/base/numeric.hpp"
#include "core/noise/modes.hpp"

namespace zerorate::core {

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

}  // namespace zerorate::core

/// @file
/// A bias that moves steadily.
#pragma once

#include <cstddef>

#include "core/noise/modes.hpp"

namespace zerorate::core {

/// slope t, t since the filter's start; the slope differs from start to start, and begins anew
/// where the one before has got to. It is the beginning of a decay with a time constant of 2^40
/// ticks (350 years at 100 Hz), which a predictor that holds drifts keeps as the slope itself:
/// nothing large enters its arithmetic.
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

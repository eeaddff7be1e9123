/// @file
/// The transient after power-on: an offset that decays.
#pragma once

#include <cstddef>

#include "core/base/numeric.hpp"
#include "core/noise/modes.hpp"

namespace zerorate::core {

/// amplitude exp(-t / time_constant), t since the filter's start; the amplitude differs from start
/// to start. A decaying mode with nothing that drives it.
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
    // A number that decays without end leaves the range of normal numbers, where processors are
    // slow. So the variance is kept from falling below this share of the first, far from all that
    // is measured.
    constexpr float kFloor = 1e-12F;
    writer.add_transient(one_minus_exp_neg(elapsed),
                         kFloor * variance * one_minus_exp_neg(2.0F * elapsed), amplitude_rad_s,
                         variance);
  }
};

}  // namespace zerorate::core

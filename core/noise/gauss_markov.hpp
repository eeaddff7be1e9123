/// @file
/// First-order Gauss-Markov noise (exponentially correlated).
#pragma once

#include <cstddef>

#include "core/base/numeric.hpp"
#include "core/noise/modes.hpp"

namespace zerorate::core {

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

}  // namespace zerorate::core

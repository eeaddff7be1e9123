/// @file
/// Rate random walk (RRW).
#pragma once

#include <cstddef>

#include "core/noise/modes.hpp"

namespace zerorate::core {

/// The bias walks at random: it costs no state, because it drives the level itself.
struct RandomWalk {
  static constexpr std::size_t kDecaying = 0;
  static constexpr std::size_t kRotating = 0;

  float coefficient_rad_s_sqrt_s = 0.0F;  ///< K of IEEE Std 952: variance K^2 t after time t

  template <std::size_t R, std::size_t C>
  constexpr void contribute(Duration tick, ModeWriter<R, C>& writer) const {
    writer.add_walk(coefficient_rad_s_sqrt_s * coefficient_rad_s_sqrt_s * tick.in_seconds());
  }
};

}  // namespace zerorate::core

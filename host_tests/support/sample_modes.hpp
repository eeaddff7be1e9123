/// @file
/// Noise models that the tests of several rooms share.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/noise/terms.hpp"

namespace zerorate::testing {

/// N decades from one tick on with the slope of order d, unit variance in the fastest.
template <std::size_t N>
auto flicker_like(core::Duration tick, double order) {
  core::FlickerDecades<N> flicker;
  for (std::size_t i = 0; i < N; ++i) {
    const double tau_ticks = std::pow(10.0, static_cast<double>(i));
    flicker.time_constant_s[i] = tick.in_seconds() * static_cast<float>(tau_ticks);
    flicker.variance_rad2_s2[i] = static_cast<float>(std::pow(tau_ticks, 2.0 * order - 1.0));
  }
  return flicker;
}

/// One of each kind of mode, all of them visible within a few hundred ticks of one second.
inline auto mixed_modes(core::Start start) {
  return core::compose(
      core::Duration::seconds(1), start,
      core::FlickerDecades<4>{.time_constant_s = {1.0F, 10.0F, 100.0F, 1000.0F},
                              .variance_rad2_s2 = {1.0F, 1.1F, 1.0F, 1.4F}},
      core::RandomWalk{.coefficient_rad_s_sqrt_s = 0.05F},
      core::GaussMarkov{.sigma_rad_s = 0.7F, .time_constant_s = 37.0F},
      core::Harmonic{.rms_rad_s = 0.8F, .frequency_hz = 0.11F, .coherence_time_s = 60.0F});
}

}  // namespace zerorate::testing

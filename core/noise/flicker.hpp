/// @file
/// 1/f^(2d) noise (bias instability) as one first-order process per decade of time constant.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/numeric.hpp"
#include "core/noise/modes.hpp"

namespace zerorate::core {

/// Flicker noise compressed to one state per decade: (Keshner 1982);
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

}  // namespace zerorate::core

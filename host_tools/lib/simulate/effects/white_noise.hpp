#pragma once

#include <cmath>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"

namespace zerorate::simulate {

/// Angle random walk: white rate noise of two-sided density N^2.
struct WhiteNoise {
  static constexpr std::string_view kName = "white_noise";

  double angle_random_walk_rad_rt_s = 0.0;  ///< N, rad/sqrt(s)

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const double sigma =
        std::sqrt(spectrum::white_variance(angle_random_walk_rad_rt_s, signal.sample_period_s));
    for (std::size_t k = 0; k < signal.size(); ++k) {
      signal.rate_rad_s[k] += sigma * stream.normal(static_cast<std::int64_t>(k));
    }
  }
};

}  // namespace zerorate::simulate

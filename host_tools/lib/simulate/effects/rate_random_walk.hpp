#pragma once

#include <cmath>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// Rate random walk: a sum of independent steps, 0 at sample 0; density K^2 / (2 pi nu)^2.
struct RateRandomWalk {
  static constexpr std::string_view kName = "rate_random_walk";

  double rate_random_walk_rad_s_rt_s = 0.0;  ///< K, rad/s/sqrt(s)

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const double step = rate_random_walk_rad_s_rt_s * std::sqrt(signal.sample_period_s);
    double walk = 0.0;
    for (std::size_t k = 0; k < signal.size(); ++k) {
      signal.rate_rad_s[k] += walk;
      walk += step * stream.normal(static_cast<std::int64_t>(k));
    }
  }
};

}  // namespace zerorate::simulate

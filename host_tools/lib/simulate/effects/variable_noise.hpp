#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"

namespace zerorate::simulate {

/// White noise whose strength comes and goes (an engine idling, a supply under load): its density
/// swings as a raised cosine between zero, at sample 0, and a peak.
struct VariableNoise {
  static constexpr std::string_view kName = "variable_noise";

  double peak_angle_random_walk_rad_rt_s = 0.0;
  double swing_period_s = 600.0;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const double peak_sigma = std::sqrt(
        spectrum::white_variance(peak_angle_random_walk_rad_rt_s, signal.sample_period_s));
    for (std::size_t k = 0; k < signal.size(); ++k) {
      // sqrt((1 - cos 2a) / 2) = |sin a|
      const double share = std::sin(std::numbers::pi * signal.time_s(k) / swing_period_s);
      signal.rate_rad_s[k] += peak_sigma * share * stream.normal(static_cast<std::int64_t>(k));
    }
  }
};

}  // namespace zerorate::simulate

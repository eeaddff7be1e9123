#pragma once

#include <cmath>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// A bias that switches between two levels at random, with exponential dwell times (a trapped
/// charge; "popcorn noise"); stationary from sample 0. Switches within one sample are seen at its
/// end only.
struct RandomTelegraphNoise {
  static constexpr std::string_view kName = "random_telegraph_noise";

  double height_rad_s = 0.0;  ///< from the lower level, 0, to the upper
  double mean_low_s = 10.0;
  double mean_high_s = 10.0;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    // The two-state Markov chain in continuous time, sampled exactly.
    const double rate_hz = 1.0 / mean_low_s + 1.0 / mean_high_s;
    const double mixed = -std::expm1(-rate_hz * signal.sample_period_s);
    const double share_high = mean_high_s / (mean_low_s + mean_high_s);
    bool high = stream.uniform(0) < share_high;
    for (std::size_t k = 0; k < signal.size(); ++k) {
      if (k > 0) {
        const double switches = mixed * (high ? 1.0 - share_high : share_high);
        high = high != (stream.uniform(static_cast<std::int64_t>(k)) < switches);
      }
      if (high) signal.rate_rad_s[k] += height_rad_s;
    }
  }
};

}  // namespace zerorate::simulate

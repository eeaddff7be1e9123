#pragma once

#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// A bias that changes at a constant rate, 0 at sample 0.
struct RateRamp {
  static constexpr std::string_view kName = "rate_ramp";

  double slope_rad_s2 = 0.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (std::size_t k = 0; k < signal.size(); ++k) {
      signal.rate_rad_s[k] += slope_rad_s2 * signal.time_s(k);
    }
  }
};

}  // namespace zerorate::simulate

#pragma once

#include <cmath>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// The exponential that dies out after switch-on at sample 0.
struct WarmUpTransient {
  static constexpr std::string_view kName = "warm_up_transient";

  double amplitude_rad_s = 0.0;  ///< at sample 0
  double time_constant_s = 60.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (std::size_t k = 0; k < signal.size(); ++k) {
      signal.rate_rad_s[k] += amplitude_rad_s * std::exp(-signal.time_s(k) / time_constant_s);
    }
  }
};

}  // namespace zerorate::simulate

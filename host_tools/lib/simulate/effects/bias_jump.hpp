#pragma once

#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// A bias that is another from one moment on, as after a shock.
struct BiasJump {
  static constexpr std::string_view kName = "bias_jump";

  double height_rad_s = 0.0;
  double time_s = 0.0;  ///< the first sample at or after it has the new bias

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (std::size_t k = 0; k < signal.size(); ++k) {
      if (signal.time_s(k) >= time_s) signal.rate_rad_s[k] += height_rad_s;
    }
  }
};

}  // namespace zerorate::simulate

#pragma once

#include <algorithm>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// The end of the measuring range, on everything so far.
struct Saturation {
  static constexpr std::string_view kName = "saturation";

  double full_scale_rad_s = 1.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (double& rate : signal.rate_rad_s) {
      rate = std::clamp(rate, -full_scale_rad_s, full_scale_rad_s);
    }
  }
};

}  // namespace zerorate::simulate

#pragma once

#include <cmath>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// Rounding of everything so far to whole steps; half a step goes away from zero.
struct Quantization {
  static constexpr std::string_view kName = "quantization";

  double step_rad_s = 1.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (double& rate : signal.rate_rad_s) rate = step_rad_s * std::round(rate / step_rad_s);
  }
};

}  // namespace zerorate::simulate

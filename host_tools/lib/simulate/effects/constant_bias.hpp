#pragma once

#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// The bias of this power-up.
struct ConstantBias {
  static constexpr std::string_view kName = "constant_bias";

  double bias_rad_s = 0.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (double& rate : signal.rate_rad_s) rate += bias_rad_s;
  }
};

}  // namespace zerorate::simulate

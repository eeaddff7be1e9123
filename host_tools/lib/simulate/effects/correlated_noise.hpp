#pragma once

#include <cmath>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// First-order Gauss-Markov noise, stationary from sample 0: autocovariance
/// sigma^2 exp(-|t| / time constant), sampled exactly.
struct CorrelatedNoise {
  static constexpr std::string_view kName = "correlated_noise";

  double sigma_rad_s = 0.0;
  double time_constant_s = 1.0;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const double decay = std::exp(-signal.sample_period_s / time_constant_s);
    const double drive = std::sqrt(-std::expm1(-2.0 * signal.sample_period_s / time_constant_s));
    double state = stream.normal(0);
    for (std::size_t k = 0; k < signal.size(); ++k) {
      if (k > 0) state = decay * state + drive * stream.normal(static_cast<std::int64_t>(k));
      signal.rate_rad_s[k] += sigma_rad_s * state;
    }
  }
};

}  // namespace zerorate::simulate

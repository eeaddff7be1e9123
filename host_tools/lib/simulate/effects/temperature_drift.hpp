#pragma once

#include <cmath>
#include <stdexcept>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// A bias driven by the temperature of the signal, which the sensing element follows with a lag.
/// Throws std::invalid_argument when the signal has no temperature.
struct TemperatureDrift {
  static constexpr std::string_view kName = "temperature_drift";

  double linear_rad_s_per_k = 0.0;
  double quadratic_rad_s_per_k2 = 0.0;
  double reference_degc = 25.0;  ///< where the drift is 0
  double lag_s = 0.0;            ///< time constant of the sensing element; 0: none

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    if (signal.temperature_degc.size() != signal.size()) {
      throw std::invalid_argument(
          "TemperatureDrift: the signal has no temperature for each sample");
    }
    if (signal.size() == 0) return;
    const double follow = lag_s > 0.0 ? -std::expm1(-signal.sample_period_s / lag_s) : 1.0;
    double element_degc = signal.temperature_degc.front();
    for (std::size_t k = 0; k < signal.size(); ++k) {
      element_degc += follow * (signal.temperature_degc[k] - element_degc);
      const double excess_k = element_degc - reference_degc;
      signal.rate_rad_s[k] += (linear_rad_s_per_k + quadratic_rad_s_per_k2 * excess_k) * excess_k;
    }
  }
};

}  // namespace zerorate::simulate

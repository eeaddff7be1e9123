#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// A line in the spectrum, such as vibration or a supply's ripple. A frequency above half the
/// sample rate folds, as it does in the sensor.
struct PeriodicDisturbance {
  static constexpr std::string_view kName = "periodic_disturbance";

  double amplitude_rad_s = 0.0;  ///< peak
  double frequency_hz = 1.0;
  double phase_rad = 0.0;  ///< of the sine at sample 0

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (std::size_t k = 0; k < signal.size(); ++k) {
      const double cycles = frequency_hz * signal.time_s(k);
      const double turn = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
      signal.rate_rad_s[k] += amplitude_rad_s * std::sin(turn + phase_rad);
    }
  }
};

}  // namespace zerorate::simulate

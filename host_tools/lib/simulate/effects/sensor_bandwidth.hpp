#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// The sensor's low-pass of first order on everything so far: y += a (x - y) with
/// a = 1 - exp(-2 pi f_c T), at rest on the first sample. Gain 1 at zero frequency; the -3 dB point
/// is f_c as long as that is well below the sample rate.
struct SensorBandwidth {
  static constexpr std::string_view kName = "sensor_bandwidth";

  double cut_off_hz = 100.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    if (signal.size() == 0) return;
    const double share = -std::expm1(-2.0 * std::numbers::pi * cut_off_hz * signal.sample_period_s);
    double state = signal.rate_rad_s.front();
    for (double& rate : signal.rate_rad_s) {
      state += share * (rate - state);
      rate = state;
    }
  }
};

}  // namespace zerorate::simulate

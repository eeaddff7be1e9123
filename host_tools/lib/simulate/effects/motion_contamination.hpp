#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/effects/signal.hpp"

namespace zerorate::simulate {

/// Rotation inside what is held for a standstill: knocks at random moments (a door, a passenger),
/// each a half-sine of rate with a normal peak.
struct MotionContamination {
  static constexpr std::string_view kName = "motion_contamination";

  double peak_sigma_rad_s = 0.0;
  double mean_interval_s = 60.0;
  double duration_s = 0.5;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const random::RandomStream peaks = stream.substream("peak");
    double start_s = 0.0;
    for (std::int64_t knock = 0;; ++knock) {
      start_s -= mean_interval_s * std::log(stream.uniform(knock));
      const auto first = std::ceil(start_s / signal.sample_period_s);
      if (first >= static_cast<double>(signal.size())) return;
      const double peak_rad_s = peak_sigma_rad_s * peaks.normal(knock);
      for (auto k = static_cast<std::size_t>(first); k < signal.size(); ++k) {
        const double share = (signal.time_s(k) - start_s) / duration_s;
        if (share >= 1.0) break;
        signal.rate_rad_s[k] += peak_rad_s * std::sin(std::numbers::pi * share);
      }
    }
  }
};

}  // namespace zerorate::simulate

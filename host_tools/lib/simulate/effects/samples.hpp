/// @file
/// Effects on samples: how the sensor, its resolution and its surroundings change what is read.
#pragma once

#include <algorithm>
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

/// Rounding of everything so far to whole steps; half a step goes away from zero.
struct Quantization {
  static constexpr std::string_view kName = "quantization";

  double step_rad_s = 1.0;

  void apply(Signal& signal, const random::RandomStream& /*stream*/) const {
    for (double& rate : signal.rate_rad_s) rate = step_rad_s * std::round(rate / step_rad_s);
  }
};

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

/// Single wild samples (a bit error, a disturbed transfer): a normal error is added to a share of
/// the samples, chosen independently.
struct Outliers {
  static constexpr std::string_view kName = "outliers";

  double sigma_rad_s = 0.0;
  double probability = 0.0;

  void apply(Signal& signal, const random::RandomStream& stream) const {
    const random::RandomStream sizes = stream.substream("size");
    for (std::size_t k = 0; k < signal.size(); ++k) {
      const auto index = static_cast<std::int64_t>(k);
      if (stream.uniform(index) < probability) {
        signal.rate_rad_s[k] += sigma_rad_s * sizes.normal(index);
      }
    }
  }
};

/// Samples that are lost on the way, in runs of geometric length (a busy bus, a full FIFO). The run
/// of lost samples and the run between two losses are both memoryless.
struct DroppedSamples {
  static constexpr std::string_view kName = "dropped_samples";

  double probability = 0.0;       ///< probability of a run of losses after a sample that arrived
  double mean_run_samples = 1.0;  ///< at least 1

  void apply(Signal& signal, const random::RandomStream& stream) const {
    bool lost = false;
    for (std::size_t k = 0; k < signal.size(); ++k) {
      const double loss = lost ? 1.0 - 1.0 / mean_run_samples : probability;
      lost = stream.uniform(static_cast<std::int64_t>(k)) < loss;
      if (lost) signal.missing[k] = true;
    }
  }
};

}  // namespace zerorate::simulate

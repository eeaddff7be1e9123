/// @file
/// Inputs that a bias may follow, tick by tick over all standstills of a recording.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/base/time.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::diagnose {

/// Means of the rates at rest, and the inputs of the same ticks. A tick with too few
/// accelerations is left out.
struct InputTicks {
  core::Duration tick;
  core::Duration sample_period;  ///< the mean, see identify::RestSamples
  std::vector<identify::TickMean> means;
  std::vector<std::array<double, 3>> acceleration_g;  ///< mean of the tick; 1 g upwards at rest
  /// Variance of the acceleration within the tick, summed over its axes; empty where ticks hold
  /// fewer than eight samples.
  std::vector<double> vibration_g2;
  std::vector<double> temperature_degc;  ///< mean of the tick; empty where a tick has none
  std::vector<std::size_t> standstill;   ///< number of the standstill that the tick lies in

  [[nodiscard]] std::size_t size() const { return means.size(); }
  [[nodiscard]] std::size_t standstills() const {
    return standstill.empty() ? 0 : standstill.back() + 1;
  }
};

/// Ticks of identify::identification_tick(); none where the samples have no acceleration.
[[nodiscard]] InputTicks input_ticks_of(const identify::RestSamples& samples);

/// The first ticks.
[[nodiscard]] InputTicks beginning_of(const InputTicks& ticks, std::size_t size);

/// Mean of a quantity over the ticks of each standstill that has any, in order.
/// @param values  one for each tick
[[nodiscard]] std::vector<double> means_by_standstill(const InputTicks& ticks,
                                                      const std::vector<double>& values);

}  // namespace zerorate::diagnose

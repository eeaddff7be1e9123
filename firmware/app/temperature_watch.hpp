/// @file
/// Temperatures that no sensor can have had.
#pragma once

#include "core/base/time.hpp"
#include "drivers/common/gyro_source.hpp"

namespace zerorate::app {

/// A temperature that is more than half a degree from the one before, within a second, was not
/// read: its bytes are of two conversions, or the transfer failed. It is withheld until the next
/// one agrees with it.
class TemperatureWatch {
 public:
  /// Takes each sample in turn, and takes away a temperature that was not read.
  constexpr void take(drivers::GyroSample& sample) {
    constexpr float kLargestStep_degc = 0.5F;
    if (!sample.has_temperature) return;
    const float degc = sample.temperature.degc();
    const float step = degc - newest_degc_;
    const bool is_next = has_newest_ && sample.time - newest_at_ < core::Duration::seconds(1);
    newest_degc_ = degc;
    newest_at_ = sample.time;
    has_newest_ = true;
    if (is_next && (step > kLargestStep_degc || -step > kLargestStep_degc)) {
      sample.has_temperature = false;
    }
  }

 private:
  core::Instant newest_at_;
  float newest_degc_ = 0.0F;
  bool has_newest_ = false;
};

}  // namespace zerorate::app

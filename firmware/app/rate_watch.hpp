/// @file
/// Samples a second against the nominal rate of the gyro.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"

namespace zerorate::app {

/// Counts samples over windows of four seconds, of sixteen periods where those are longer. Fewer
/// than three quarters of the nominal number, or more than four thirds, are another rate: half of
/// the samples lost to a second reader or a wrong edge, or a chip that is set otherwise. No
/// oscillator of a gyro is off by so much.
class RateWatch {
 public:
  /// The gyro was started: the next sample begins a window.
  constexpr void restart() { has_begun_ = false; }

  /// Takes the samples of one reading.
  /// @param period  nominal
  constexpr void take(core::Instant now, std::uint32_t samples, core::Duration period) {
    if (!has_begun_) {
      if (samples == 0) return;
      has_begun_ = true;
      begin_ = now;  // these samples are older than the window
      samples_ = 0;
      return;
    }
    samples_ += samples;
    const core::Duration window = std::max(core::Duration::seconds(4), period * 16);
    const core::Duration elapsed = now - begin_;
    if (elapsed < window) return;
    const std::int64_t nominal = elapsed / period;
    const std::int64_t counted = samples_;
    is_off_ = counted * 4 < nominal * 3 || counted * 3 > nominal * 4;
    samples_per_second_ = core::to_float(counted) / elapsed.in_seconds();
    begin_ = now;
    samples_ = 0;
  }

  /// Verdict on the newest window; false before the first one.
  [[nodiscard]] constexpr bool is_off() const { return is_off_; }
  /// Rate of the newest window; 0 before the first one.
  [[nodiscard]] constexpr float samples_per_second() const { return samples_per_second_; }

 private:
  core::Instant begin_;  ///< begin of the present window
  std::uint32_t samples_ = 0;
  float samples_per_second_ = 0.0F;
  bool has_begun_ = false;
  bool is_off_ = false;
};

}  // namespace zerorate::app

/// @file
/// Clock for tests: time passes only by advance().
#pragma once

#include "core/base/time.hpp"
#include "hal/contract/monotonic_clock.hpp"

namespace zerorate::hal::sim {

/// A MonotonicClock; a time before the present one is ignored, so that it never runs backwards.
class SimulatedClock {
 public:
  /// @param start may be negative, for what has to happen before a recording's time 0
  explicit SimulatedClock(core::Instant start = {}) : now_(start) {}

  [[nodiscard]] core::Instant now() const { return now_; }
  void advance(core::Duration time) { advance_to(now_ + time); }
  void advance_to(core::Instant time) {
    if (time > now_) now_ = time;
  }

 private:
  core::Instant now_;
};
static_assert(MonotonicClock<SimulatedClock>);

}  // namespace zerorate::hal::sim

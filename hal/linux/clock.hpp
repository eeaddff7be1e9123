/// @file
/// The node's clock on Linux.
#pragma once

#include <ctime>

#include "core/base/time.hpp"
#include "hal/contract/monotonic_clock.hpp"

namespace zerorate::hal::linux_os {

/// CLOCK_MONOTONIC: the clock of the kernel's line events, not moved when the time of day is set.
class KernelClock {
 public:
  [[nodiscard]] static core::Instant now() { return read(CLOCK_MONOTONIC); }
  /// Time for which the machine has slept since it was started. now() does not count it.
  [[nodiscard]] static core::Duration slept() {
    const core::Instant awake = now();
    return read(CLOCK_BOOTTIME) - awake;
  }

 private:
  static core::Instant read(clockid_t clock) {
    std::timespec time{};
    (void)clock_gettime(clock, &time);  // cannot fail for these clocks
    return core::Instant{} + core::Duration::seconds(time.tv_sec) +
           core::Duration::nanoseconds(time.tv_nsec);
  }
};
static_assert(MonotonicClock<KernelClock>);

}  // namespace zerorate::hal::linux_os

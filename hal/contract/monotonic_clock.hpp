/// @file
/// The one clock of a node.
#pragma once

#include <concepts>

#include "core/base/time.hpp"

namespace zerorate::hal {

/// `now()` is the time since some fixed moment.
///
/// For authors of back ends: never decreases, never jumps when the time of day is set, resolves
/// 1 us or better, does not wrap within the life of the product (widen a 32-bit counter), may be
/// called from interrupts. On Linux it is CLOCK_MONOTONIC, the clock of kernel line events.
template <class Clock>
concept MonotonicClock = requires(const Clock& clock) {
  { clock.now() } -> std::same_as<core::Instant>;
};

}  // namespace zerorate::hal

/// @file
/// A pin by which a sensor signals that a sample, or a batch of them, waits.
#pragma once

#include <concepts>
#include <optional>

#include "core/base/time.hpp"

namespace zerorate::hal {

/// `take_edge()` gives the time of the latest active edge that was not taken yet, and forgets it.
///
/// For authors of applications: hand the stamp to the driver as the `now` of the sample, so that
/// the sample carries the time of the sensor and not that of the loop. Several edges between two
/// calls give one stamp, the latest: the sensor's registers hold only the latest sample too.
///
/// For authors of back ends: stamp with the application's MonotonicClock at the edge. Never block.
template <class Pin>
concept DataReady = requires(Pin& pin) {
  { pin.take_edge() } -> std::same_as<std::optional<core::Instant>>;
};

}  // namespace zerorate::hal

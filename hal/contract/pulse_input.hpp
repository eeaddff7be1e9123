/// @file
/// Time-stamped pulses, such as those of an odometer.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "hal/contract/bus_error.hpp"

namespace zerorate::hal {

/// Result of one call of `read_pulses`.
struct PulseBatch {
  std::size_t count = 0;   ///< stamps written to the front of the caller's buffer
  std::uint32_t lost = 0;  ///< pulses since the last call whose stamps could not be kept
};

/// `read_pulses(stamps)` hands over the pulses that came since the last call, oldest first.
///
/// For authors of applications:
/// - A full buffer (count == stamps.size()) means that there may be more: call again.
/// - Lost pulses were real pulses: the vehicle moved. They lie between the stamps of this batch and
///   the call before it.
/// - An error means that pulses may have been missed without being counted.
///
/// For authors of back ends:
/// - Stamps come from the application's MonotonicClock and never decrease. Take them at the edge
///   (interrupt, capture unit or kernel event), never at the call.
/// - Count the pulses that your queue has no room for; never drop in silence. Never block.
template <class Input>
concept PulseInput = requires(Input& input, std::span<core::Instant> stamps) {
  { input.read_pulses(stamps) } -> std::same_as<core::Result<PulseBatch, BusError>>;
};

}  // namespace zerorate::hal

/// @file
/// One device on an SPI bus, chip select included.
#pragma once

#include <concepts>
#include <span>

#include "core/base/result.hpp"
#include "hal/contract/bus_error.hpp"
#include "hal/contract/bus_operation.hpp"

namespace zerorate::hal {

/// `transaction(operations)` does all operations in order under one assertion of chip select.
///
/// For authors of drivers:
/// - What is on the wire: select, the operations without a gap in selection, deselect. A read
///   receives while 0x00 is sent; what arrives during a write is dropped; an exchange does both.
/// - On an error nothing is known about the device or the read buffers, except that the device is
///   deselected again. Retrying is the application's decision, never the driver's or the back
///   end's.
/// - An empty span succeeds and touches nothing.
///
/// For authors of back ends:
/// - Mode, clock, bit order, the pause between two selections and the sharing of the bus belong to
///   you; the driver's README names the mode, the highest clock and the pause, where it needs one.
///   Block until done or until a time limit of your own, then report BusError::timeout.
/// - Release chip select on every path. If both the transfer and the release fail, report the
///   transfer's error.
/// - Must be callable from one thread at a time; not from an interrupt.
template <class Device>
concept SpiDevice = requires(Device& device, std::span<const Operation> operations) {
  { device.transaction(operations) } -> std::same_as<core::Result<void, BusError>>;
};

}  // namespace zerorate::hal

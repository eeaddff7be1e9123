/// @file
/// An I2C bus; the device is named in each transaction, as on the wire.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "hal/contract/bus_error.hpp"
#include "hal/contract/bus_operation.hpp"

namespace zerorate::hal {

/// A 7-bit device address, without the read/write bit: `I2cAddress{0x6A}`.
enum class I2cAddress : std::uint8_t {};

/// `transaction(address, operations)` does all operations in order between one START and one STOP.
///
/// For authors of drivers:
/// - What is on the wire: START and address with the direction of the first operation; a repeated
///   START and the address before every further operation; STOP at the end. Adjacent operations of
///   one direction are not merged: each begins with its own START.
/// - The last byte of each read is answered with NACK, every other with ACK.
/// - On an error nothing is known about the device or the read buffers, except that a STOP was sent
///   where the bus allowed it. Retrying is the application's decision.
/// - An empty span succeeds and touches nothing.
/// - There is no exchange on I2C: asking for one is a programmer error.
///
/// For authors of back ends:
/// - Clock, pull-ups, clock stretching and the sharing of the bus belong to you. Block until the
///   transaction is done, or until a time limit of your own: then report BusError::timeout.
/// - An address or data byte without acknowledge is BusError::nack, a lost arbitration
///   BusError::arbitration_lost; if the STOP fails too, report the first error.
/// - Must be callable from one thread at a time; not from an interrupt.
template <class Bus>
concept I2cBus = requires(Bus& bus, I2cAddress address, std::span<const Operation> operations) {
  { bus.transaction(address, operations) } -> std::same_as<core::Result<void, BusError>>;
};

}  // namespace zerorate::hal

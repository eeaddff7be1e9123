/// @file
/// Chips with 8-bit register addresses, over SPI or I2C: one way to talk to both.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "hal/contract/bus_operation.hpp"
#include "hal/contract/i2c_bus.hpp"
#include "hal/contract/spi_device.hpp"

namespace zerorate::drivers {

/// Bus of a register driver. Each call is one transaction.
/// - `read(first, out)` fills out from consecutive registers (the chip increments the address).
/// - `write(address, value)` writes one register.
template <class Bus>
concept RegisterBus = requires(Bus& bus, std::uint8_t address, std::span<std::uint8_t> out) {
  { bus.read(address, out) } -> std::same_as<core::Result<void, hal::BusError>>;
  { bus.write(address, address) } -> std::same_as<core::Result<void, hal::BusError>>;
};

/// Registers over SPI as ST, Bosch and TDK arrange them: the address in 7 bits, bit 7 set to read.
/// Holds a reference: the device must outlive it.
template <hal::SpiDevice Device>
class SpiRegisters {
 public:
  constexpr explicit SpiRegisters(Device& device) : device_(&device) {}

  core::Result<void, hal::BusError> read(std::uint8_t first, std::span<std::uint8_t> out) {
    const std::array<std::uint8_t, 1> command{static_cast<std::uint8_t>(first | kRead)};
    const std::array operations{hal::Operation::write(command), hal::Operation::read(out)};
    return device_->transaction(operations);
  }

  core::Result<void, hal::BusError> write(std::uint8_t address, std::uint8_t value) {
    const std::array<std::uint8_t, 2> command{address, value};
    const std::array operations{hal::Operation::write(command)};
    return device_->transaction(operations);
  }

 private:
  static constexpr std::uint8_t kRead = 0x80;
  Device* device_;
};

/// Registers over I2C: the address is written first, and a read follows a repeated START.
/// Holds a reference: the bus must outlive it.
template <hal::I2cBus Bus>
class I2cRegisters {
 public:
  constexpr I2cRegisters(Bus& bus, hal::I2cAddress device) : bus_(&bus), device_(device) {}

  core::Result<void, hal::BusError> read(std::uint8_t first, std::span<std::uint8_t> out) {
    const std::array<std::uint8_t, 1> command{first};
    const std::array operations{hal::Operation::write(command), hal::Operation::read(out)};
    return bus_->transaction(device_, operations);
  }

  core::Result<void, hal::BusError> write(std::uint8_t address, std::uint8_t value) {
    const std::array<std::uint8_t, 2> command{address, value};
    const std::array operations{hal::Operation::write(command)};
    return bus_->transaction(device_, operations);
  }

 private:
  Bus* bus_;
  hal::I2cAddress device_;
};

}  // namespace zerorate::drivers

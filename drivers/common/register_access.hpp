/// @file
/// Chips with 8-bit register addresses, over SPI or I2C: one way to talk to both, and registers as
/// types. Reading or writing a register is one bus transaction.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "drivers/common/driver_error.hpp"
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

/// Address and values of one transaction; at most kMostBurst values. The chip decides whether they
/// go to one register or to consecutive ones.
class BurstCommand {
 public:
  static constexpr std::size_t kMostBurst = 64;
  constexpr BurstCommand(std::uint8_t address, std::span<const std::uint8_t> values)
      : size_(1 + values.size()) {
    ZERORATE_ASSERT(values.size() <= kMostBurst);
    bytes_[0] = address;
    std::copy(values.begin(), values.end(), bytes_.begin() + 1);
  }
  [[nodiscard]] constexpr std::span<const std::uint8_t> bytes() const {
    return std::span{bytes_}.first(size_);
  }

 private:
  std::array<std::uint8_t, 1 + kMostBurst> bytes_{};
  std::size_t size_;
};

/// Registers over SPI as ST, Bosch and TDK arrange them: the address in 7 bits, bit 7 set to read.
/// Holds a reference: the device must outlive it.
template <hal::SpiDevice Device>
class SpiRegisters {
 public:
  constexpr explicit SpiRegisters(Device& device) : device_(&device) {}

  // Not inlined: a driver has many calls, and a board counts bytes.
  [[gnu::noinline]] core::Result<void, hal::BusError> read(std::uint8_t first,
                                                           std::span<std::uint8_t> out) {
    const std::array<std::uint8_t, 1> command{static_cast<std::uint8_t>(first | kRead)};
    const std::array operations{hal::Operation::write(command), hal::Operation::read(out)};
    return device_->transaction(operations);
  }

  [[gnu::noinline]] core::Result<void, hal::BusError> write(std::uint8_t address,
                                                            std::uint8_t value) {
    const std::array<std::uint8_t, 2> command{address, value};
    const std::array operations{hal::Operation::write(command)};
    return device_->transaction(operations);
  }
  core::Result<void, hal::BusError> write(std::uint8_t address,
                                          std::span<const std::uint8_t> values) {
    const BurstCommand command{address, values};
    const std::array operations{hal::Operation::write(command.bytes())};
    return device_->transaction(operations);
  }

 protected:
  static constexpr std::uint8_t kRead = 0x80;
  Device* device_;
};

/// Registers over SPI as some of Bosch's dies have them: a byte without meaning comes before what
/// is read. Holds a reference: the device must outlive it.
template <hal::SpiDevice Device>
class SpiRegistersWithDummy : public SpiRegisters<Device> {
 public:
  using SpiRegisters<Device>::SpiRegisters;

  core::Result<void, hal::BusError> read(std::uint8_t first, std::span<std::uint8_t> out) {
    const std::array<std::uint8_t, 1> command{static_cast<std::uint8_t>(first | this->kRead)};
    std::array<std::uint8_t, 1> dummy{};
    const std::array operations{hal::Operation::write(command), hal::Operation::read(dummy),
                                hal::Operation::read(out)};
    return this->device_->transaction(operations);
  }
};
template <hal::SpiDevice Device>
SpiRegistersWithDummy(Device&) -> SpiRegistersWithDummy<Device>;

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
  core::Result<void, hal::BusError> write(std::uint8_t address,
                                          std::span<const std::uint8_t> values) {
    const BurstCommand command{address, values};
    const std::array operations{hal::Operation::write(command.bytes())};
    return bus_->transaction(device_, operations);
  }

 private:
  Bus* bus_;
  hal::I2cAddress device_;
};

/// Whether a bus is SPI: some chips have to be set to it.
template <RegisterBus Bus>
inline constexpr bool kIsSpi = false;
template <hal::SpiDevice Device>
inline constexpr bool kIsSpi<SpiRegisters<Device>> = true;
template <hal::SpiDevice Device>
inline constexpr bool kIsSpi<SpiRegistersWithDummy<Device>> = true;

/// A bus that writes several values in one transaction, at most BurstCommand::kMostBurst.
template <class Bus>
concept BurstBus = RegisterBus<Bus> && requires(Bus& bus, std::span<const std::uint8_t> values) {
  { bus.write(std::uint8_t{}, values) } -> std::same_as<core::Result<void, hal::BusError>>;
};

enum class Access : std::uint8_t { read_only, write_only, read_write };

/// One 8-bit register: `inline constexpr Register<0x0F, Access::read_only, 0x6C> kWhoAmI;`
/// An empty type: it costs nothing to pass. Reading or writing against its Access is refused by the
/// compiler (register_access.hpp, configuration_table.hpp).
template <std::uint8_t Address, Access Kind, std::uint8_t Reset = 0x00>
struct Register {
  static constexpr std::uint8_t address = Address;
  static constexpr std::uint8_t reset = Reset;
  static constexpr bool is_readable = Kind != Access::write_only;
  static constexpr bool is_writable = Kind != Access::read_only;
};

/// Reads consecutive registers in one burst, beginning with the one given.
template <RegisterBus Bus, std::uint8_t Address, Access Kind, std::uint8_t Reset>
core::Result<void, DriverError> read_registers(Bus& bus, Register<Address, Kind, Reset> first,
                                               std::span<std::uint8_t> out) {
  static_assert(first.is_readable, "this register is write-only");
  if (const auto done = bus.read(Address, out); !done) return bus_failed(done.error(), Address);
  return {};
}

/// Reads one register.
template <RegisterBus Bus, std::uint8_t Address, Access Kind, std::uint8_t Reset>
core::Result<std::uint8_t, DriverError> read_register(Bus& bus,
                                                      Register<Address, Kind, Reset> reg) {
  std::array<std::uint8_t, 1> value{};
  if (const auto done = read_registers(bus, reg, value); !done) {
    return core::Unexpected{done.error()};
  }
  return value[0];
}

/// Writes one register.
template <RegisterBus Bus, std::uint8_t Address, Access Kind, std::uint8_t Reset>
core::Result<void, DriverError> write_register(Bus& bus, Register<Address, Kind, Reset> reg,
                                               std::uint8_t value) {
  static_assert(reg.is_writable, "this register is read-only");
  if (const auto done = bus.write(Address, value); !done) return bus_failed(done.error(), Address);
  return {};
}

}  // namespace zerorate::drivers

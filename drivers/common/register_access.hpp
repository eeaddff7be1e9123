/// @file
/// Reading and writing typed registers. Each function is one bus transaction.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/register_bus.hpp"

namespace zerorate::drivers {

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

/// @file
/// A chip's registers as types, so that a wrong access does not compile.
#pragma once

#include <cstdint>

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

}  // namespace zerorate::drivers

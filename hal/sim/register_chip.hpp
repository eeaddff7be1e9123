/// @file
/// What a simulated bus needs of a simulated chip.
#pragma once

#include <concepts>
#include <cstdint>

namespace zerorate::hal::sim {

/// - `read_register(address)` as the bus reads it, side effects included
/// - `write_register(address, value)` as the bus writes it
/// - `next_address(address)` where a burst goes on
template <class Chip>
concept RegisterChip = requires(Chip& chip, std::uint8_t byte) {
  { chip.read_register(byte) } -> std::same_as<std::uint8_t>;
  { chip.write_register(byte, byte) } -> std::same_as<void>;
  { chip.next_address(byte) } -> std::same_as<std::uint8_t>;
};

}  // namespace zerorate::hal::sim

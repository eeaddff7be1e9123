/// @file
/// 16-bit counts from the two bytes in which chips send them.
#pragma once

#include <cstdint>

namespace zerorate::drivers {

/// Two's complement from its low and its high byte, in whatever order the chip sends them.
[[nodiscard]] constexpr std::int16_t decode_int16(std::uint8_t low, std::uint8_t high) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
}

}  // namespace zerorate::drivers

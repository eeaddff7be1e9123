/// @file
/// Checksum of messages and saved states: CRC-32 as in Ethernet, zip and PNG.
#pragma once

#include <cstdint>
#include <span>

namespace zerorate::core {

/// CRC-32/ISO-HDLC: polynomial 0x04C11DB7 reflected, initial value and final XOR all ones. Finds
/// every burst of up to 32 wrong bits and every pair of wrong bits within 268 Mbit.
/// Cost: two table look-ups a byte; the table has 16 words.
/// @param so_far  the checksum of the bytes before these, to go on in pieces
[[nodiscard]] constexpr std::uint32_t crc32(std::span<const std::uint8_t> bytes,
                                            std::uint32_t so_far = 0) {
  // A std::array is a call for each byte where nothing is optimised.
  // NOLINTNEXTLINE(cppcoreguidelines-avoid-c-arrays)
  constexpr std::uint32_t kOfNibble[16] = {0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC,
                                           0x76DC4190, 0x6B6B51F4, 0x4DB26158, 0x5005713C,
                                           0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C,
                                           0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C};
  std::uint32_t crc = ~so_far;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    crc = kOfNibble[crc & 0xFU] ^ (crc >> 4U);
    crc = kOfNibble[crc & 0xFU] ^ (crc >> 4U);
  }
  return ~crc;
}

}  // namespace zerorate::core

/// @file
/// End-to-end protection of a frame as of profile 11 of AUTOSAR (PRS_E2EProtocol, Foundation;
/// second-hand: two open implementations, which docs/how-to/put-rates-on-can.md names).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"

namespace zerorate::wire {

/// Part of the identifier of the data in the frame and in the CRC.
enum class E2eVariant : std::uint8_t {
  both,    ///< 11A: 16 bits in the CRC alone
  nibble,  ///< 11C: 12 bits, the upper four in the frame, the lower eight in the CRC alone
};

/// Protection of one frame.
struct E2eSettings {
  std::uint16_t data_id = 0;  ///< identifier of the data, unique in the network
  E2eVariant variant = E2eVariant::nibble;
};

/// Longest data of the profile, header included: 240 bits.
inline constexpr std::size_t kMostE2eBytes = 30;
/// Length of the header: a byte of the CRC, and one of the counter and the nibble.
inline constexpr std::size_t kE2eHeaderBytes = 2;
/// Number of counts: the counter runs from 0 to 14, and 15 is never sent.
inline constexpr std::uint8_t kE2eCounts = 15;

/// CRC-8 of SAE J1850 with one more byte: polynomial 0x1D, highest bit first. The profile starts at
/// 0 and inverts nothing: start and final inversion of AUTOSAR's Crc_CalculateCRC8 cancel out.
[[nodiscard]] constexpr std::uint8_t e2e_crc8(std::uint8_t crc, std::uint8_t byte) {
  constexpr unsigned kPolynomial = 0x1D;
  unsigned rest = static_cast<unsigned>(crc) ^ byte;
  for (int bit = 0; bit < 8; ++bit) rest = (rest << 1U) ^ ((rest & 0x80U) != 0 ? kPolynomial : 0U);
  return static_cast<std::uint8_t>(rest & 0xFFU);
}

/// CRC over the identifier and all bytes behind the CRC's own.
[[nodiscard]] constexpr std::uint8_t e2e_crc_of(std::span<const std::uint8_t> frame,
                                                const E2eSettings& e2e) {
  const unsigned high = e2e.variant == E2eVariant::both ? e2e.data_id >> 8U : 0U;
  std::uint8_t crc = e2e_crc8(0, static_cast<std::uint8_t>(e2e.data_id & 0xFFU));
  crc = e2e_crc8(crc, static_cast<std::uint8_t>(high));
  for (const std::uint8_t byte : frame.subspan(1)) crc = e2e_crc8(crc, byte);
  return crc;
}

/// Writes the header: in byte 0 the CRC, in byte 1 the counter and above it the nibble (0 in 11A).
/// @param frame    its first two bytes are the header's
/// @param counter  below kE2eCounts, one more for each frame
constexpr void e2e_protect(std::span<std::uint8_t> frame, const E2eSettings& e2e,
                           std::uint8_t counter) {
  ZERORATE_ASSERT(frame.size() >= kE2eHeaderBytes && frame.size() <= kMostE2eBytes);
  ZERORATE_ASSERT(counter < kE2eCounts);
  const unsigned nibble = e2e.variant == E2eVariant::nibble ? (e2e.data_id >> 8U) & 0xFU : 0U;
  frame[1] = static_cast<std::uint8_t>(nibble << 4U | counter);
  frame[0] = e2e_crc_of(frame, e2e);
}

}  // namespace zerorate::wire

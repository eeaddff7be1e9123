/// @file
/// Records and frames whose checksum is right, whatever they hold.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/crc32.hpp"
#include "firmware/wire/little_endian.hpp"

namespace zerorate::testing {

/// Puts the CRC-32 of all that is before them into the last four bytes.
inline void put_checksum(std::span<std::uint8_t> record) {
  const auto checked = record.first(record.size() - 4);
  wire::LittleEndianWriter{record.last(4)}.put(core::crc32(checked));
}

}  // namespace zerorate::testing

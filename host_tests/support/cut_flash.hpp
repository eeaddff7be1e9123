/// @file
/// A flash of two sectors whose power can be cut at any byte.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace zerorate::testing {

/// Thrown where the power fails.
struct PowerCut {};

/// A double that hal/cortex_m/flash_storage.hpp takes for a flash. Bits are cleared only, and set
/// only by erasing a sector; a step is a byte programmed, half an erasure, or the whole of it.
struct CutFlash {
  static constexpr std::size_t kPageBytes = 256;
  static constexpr std::size_t kSectorBytes = 4096;

  // One flash a process, as on a board.
  static inline std::array<std::uint8_t, 2 * kSectorBytes> bytes{};
  static inline int erasures = 0;
  static inline bool has_stuck_bit = false;

  static void reset() {
    bytes.fill(0xFF);
    erasures = 0;
    has_stuck_bit = false;
    cut_never();
  }
  static void cut_after(std::size_t steps) { steps_left = steps; }
  static void cut_never() { steps_left = std::numeric_limits<std::size_t>::max(); }

  static void erase_sector(std::uint32_t offset) {
    ++erasures;
    const auto sector = std::span{bytes}.subspan(offset, kSectorBytes);
    step();
    // Half-way some bits are set already, in no order.
    for (std::size_t i = 0; i < kSectorBytes; ++i) {
      sector[i] = static_cast<std::uint8_t>(sector[i] | (i * 37));
    }
    step();
    for (std::uint8_t& byte : sector) byte = 0xFF;
  }
  static void program(std::uint32_t offset, std::span<const std::uint8_t> page) {
    for (std::size_t i = 0; i < page.size(); ++i) {
      step();
      std::uint8_t& byte = bytes.at(offset + i);
      byte = static_cast<std::uint8_t>(byte & page[i]);
      if (has_stuck_bit) byte |= 0x80;
    }
  }
  [[nodiscard]] static std::span<const std::uint8_t> view(std::uint32_t offset, std::size_t size) {
    return std::span{bytes}.subspan(offset, size);
  }

 private:
  static void step() {
    if (steps_left == 0) throw PowerCut{};
    --steps_left;
  }
  static inline std::size_t steps_left = std::numeric_limits<std::size_t>::max();
};

}  // namespace zerorate::testing

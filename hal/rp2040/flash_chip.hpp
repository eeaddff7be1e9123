/// @file
/// Erases and programs the flash that the program itself runs from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace zerorate::hal::rp2040 {

/// The flash chip behind the SSI, by the commands that every NOR flash of this kind has (Winbond
/// W25Q16JV, section 8.1, which a Pico carries). Offsets count from the start of the flash.
///
/// Meanwhile the flash is no memory: all that runs must stand in RAM. Interrupts wait but for
/// io_bank0, whose handler and vector are in RAM on our boards, so that no edge is stamped late.
/// Not from an interrupt. A chip that never becomes ready ends in a reset by the watchdog.
class FlashChip {
 public:
  static constexpr std::size_t kPageBytes = 256;
  static constexpr std::size_t kSectorBytes = 4096;

  /// Sets the bytes of a sector to FFh. 45 ms, at most 400.
  static void erase_sector(std::uint32_t offset) { run(kSectorErase, offset, {}); }
  /// Clears bits of a page. 0.4 ms, at most 3.
  /// @param bytes at most a page, in RAM, and not across the end of a page
  static void program(std::uint32_t offset, std::span<const std::uint8_t> bytes) {
    run(kPageProgram, offset, bytes);
  }
  /// Content of the chip now, read past the cache, which would not know (datasheet, 2.6.3).
  [[nodiscard]] static std::span<const std::uint8_t> view(std::uint32_t offset, std::size_t size) {
    constexpr std::uintptr_t kUncached = 0x1300'0000;
    // The address is the hardware's.
    // NOLINTNEXTLINE(performance-no-int-to-ptr,cppcoreguidelines-pro-type-reinterpret-cast)
    return {reinterpret_cast<const std::uint8_t*>(kUncached + offset), size};
  }

 private:
  static constexpr std::uint8_t kPageProgram = 0x02;
  static constexpr std::uint8_t kReadStatus = 0x05;
  static constexpr std::uint8_t kWriteEnable = 0x06;
  static constexpr std::uint8_t kSectorErase = 0x20;

  static void run(std::uint8_t command, std::uint32_t offset, std::span<const std::uint8_t> bytes);
};

}  // namespace zerorate::hal::rp2040

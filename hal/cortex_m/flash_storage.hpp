/// @file
/// A record in two sectors of a flash, of which one always holds the newest.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/crc32.hpp"
#include "core/base/result.hpp"
#include "hal/contract/storage.hpp"

namespace zerorate::hal::cortex_m {

/// A Storage in two sectors with room for several records each, written in turn, so that a sector
/// is erased once in as many saves: with four, 100,000 erasures last for 800,000 saves. A cut at
/// any moment leaves the record before, because a new one never touches the sector of the newest
/// but for bytes that are still erased, and counts only once its checksum is right.
///
/// A place is a header of 16 bytes and the record: "ZRF1", size, sequence number, CRC-32 of these
/// two and the record. Its first page is written last.
///
/// save() takes about a millisecond a page, and one erasure where prepare() was not called.
/// @tparam Flash  as FlashChip: erase_sector, program, view
/// @tparam Start  offset of the first sector
/// @tparam PlacesOfSector  records that share a sector
template <class Flash, std::uint32_t Start, std::size_t PlacesOfSector = 4>
class FlashStorage {
  static_assert(std::endian::native == std::endian::little);

 public:
  static constexpr std::size_t kPlaceBytes = Flash::kSectorBytes / PlacesOfSector;
  static constexpr std::size_t kLargestRecord = kPlaceBytes - 16;

  /// The newest record where it lies: until the next prepare() or save(), and with no room of its
  /// own.
  core::Result<std::span<const std::uint8_t>, StorageError> newest() const {
    const auto place = find_newest();
    if (place) return record(*place, header(*place).size);
    bool is_empty = true;
    for (std::size_t i = 0; i < kPlaces; ++i) is_empty &= header(i).mark != kMark;
    return core::Unexpected{is_empty ? StorageError::empty : StorageError::corrupt};
  }

  core::Result<std::size_t, StorageError> load(std::span<std::uint8_t> buffer) {
    const auto bytes = newest();
    if (!bytes) return core::Unexpected{bytes.error()};
    if (bytes->size() > buffer.size()) return core::Unexpected{StorageError::too_large};
    std::ranges::copy(*bytes, buffer.begin());
    return bytes->size();
  }

  /// Erases what the next save() would have to erase.
  /// @return whether there was anything: the flash was away for 45 to 400 ms then
  bool prepare() {
    const std::size_t place = next_place(find_newest());
    const bool is_needed = !is_ready(place);
    if (is_needed) Flash::erase_sector(offset(place));
    return is_needed;
  }

  core::Result<void, StorageError> save(std::span<const std::uint8_t> bytes) {
    if (const auto begun = begin_save(bytes); !begun) return begun;
    while (is_saving()) {
      if (const auto written = save_page(); !written) return written;
    }
    return {};
  }

  /// Starts a save that save_page() goes on with, for who cannot do without the flash for long.
  /// @param bytes  must stay as they are until the save is done
  core::Result<void, StorageError> begin_save(std::span<const std::uint8_t> bytes) {
    if (bytes.size() > kLargestRecord) return core::Unexpected{StorageError::too_large};
    const auto newest = find_newest();
    Header head{.size = static_cast<std::uint32_t>(bytes.size()),
                .sequence = newest ? header(*newest).sequence + 1 : 0};
    head.checksum = checksum(head, bytes);
    const std::size_t place = next_place(newest);
    if (!is_ready(place)) Flash::erase_sector(offset(place));
    const std::size_t pages = (sizeof(Header) + bytes.size() - 1) / Flash::kPageBytes + 1;
    saving_ = {.bytes = bytes, .header = head, .place = place, .pages_left = pages};
    return {};
  }
  [[nodiscard]] bool is_saving() const { return saving_.pages_left > 0; }
  /// Writes one page of the save that begin_save() started, in about a millisecond.
  core::Result<void, StorageError> save_page() {
    const std::size_t page = --saving_.pages_left;
    program(saving_, page);
    if (page == 0 && !is_intact(saving_.place)) return core::Unexpected{StorageError::io};
    return {};
  }

 private:
  static constexpr std::size_t kPlaces = 2 * PlacesOfSector;
  static constexpr std::uint32_t kMark = 0x3146525A;  // "ZRF1"
  static constexpr std::uint8_t kErased = 0xFF;

  struct Header {
    std::uint32_t mark = kMark;
    std::uint32_t size = 0;
    std::uint32_t sequence = 0;
    std::uint32_t checksum = 0;
  };

  struct Saving {
    std::span<const std::uint8_t> bytes;
    Header header;
    std::size_t place = 0;
    std::size_t pages_left = 0;
  };

  [[nodiscard]] static constexpr std::uint32_t offset(std::size_t place) {
    return Start + static_cast<std::uint32_t>(place * kPlaceBytes);
  }
  [[nodiscard]] static Header header(std::size_t place) {
    std::array<std::uint8_t, sizeof(Header)> bytes;
    std::ranges::copy(Flash::view(offset(place), sizeof(Header)), bytes.begin());
    return std::bit_cast<Header>(bytes);
  }
  [[nodiscard]] static std::span<const std::uint8_t> record(std::size_t place, std::size_t size) {
    return Flash::view(offset(place), sizeof(Header) + size).subspan(sizeof(Header));
  }
  [[nodiscard]] static std::uint32_t checksum(const Header& head,
                                              std::span<const std::uint8_t> bytes) {
    const auto numbers = std::bit_cast<std::array<std::uint8_t, 8>>(
        std::array<std::uint32_t, 2>{head.size, head.sequence});
    return core::crc32(bytes, core::crc32(numbers));
  }

  /// One page: its part of the header and of the record.
  static void program(const Saving& saving, std::size_t page) {
    std::span<const std::uint8_t> bytes = saving.bytes;
    std::array<std::uint8_t, Flash::kPageBytes> image;
    image.fill(kErased);
    std::span<std::uint8_t> rest = image;
    if (page == 0) {
      std::ranges::copy(std::bit_cast<std::array<std::uint8_t, sizeof(Header)>>(saving.header),
                        image.begin());
      rest = rest.subspan(sizeof(Header));
    } else {
      bytes = bytes.subspan(page * Flash::kPageBytes - sizeof(Header));
    }
    std::ranges::copy(bytes.first(std::min(bytes.size(), rest.size())), rest.begin());
    Flash::program(offset(saving.place) + static_cast<std::uint32_t>(page * Flash::kPageBytes),
                   image);
  }

  [[nodiscard]] static bool is_intact(std::size_t place) {
    const Header head = header(place);
    return head.mark == kMark && head.size <= kLargestRecord &&
           head.checksum == checksum(head, record(place, head.size));
  }
  [[nodiscard]] static bool is_erased(std::size_t place) {
    const auto bytes = Flash::view(offset(place), kPlaceBytes);
    return std::ranges::all_of(bytes, [](std::uint8_t byte) { return byte == kErased; });
  }
  [[nodiscard]] static std::optional<std::size_t> find_newest() {
    std::optional<std::size_t> newest;
    for (std::size_t i = 0; i < kPlaces; ++i) {
      if (!is_intact(i)) continue;
      // Sequence numbers wrap: compare by the difference.
      const bool is_newer =
          !newest || static_cast<std::int32_t>(header(i).sequence - header(*newest).sequence) > 0;
      if (is_newer) newest = i;
    }
    return newest;
  }
  /// Where the next record goes: the next erased place of the sector, or else the other sector.
  [[nodiscard]] static std::size_t next_place(std::optional<std::size_t> newest) {
    std::size_t place = newest ? (*newest + 1) % kPlaces : 0;
    while (place % PlacesOfSector != 0 && !is_erased(place)) place = (place + 1) % kPlaces;
    return place;
  }
  /// A place in the middle of a sector was chosen for being erased; the first one of a sector
  /// stands for the whole of it.
  [[nodiscard]] static bool is_ready(std::size_t place) {
    if (place % PlacesOfSector != 0) return true;
    for (std::size_t i = 0; i < PlacesOfSector; ++i) {
      if (!is_erased(place + i)) return false;
    }
    return true;
  }

  Saving saving_;
};

}  // namespace zerorate::hal::cortex_m

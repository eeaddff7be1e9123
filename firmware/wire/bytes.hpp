/// @file
/// Numbers as bytes, least significant first, whatever the processor.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"

namespace zerorate::wire {

/// Fills a buffer from the front. Writing beyond its end is a programmer error.
class ByteWriter {
 public:
  constexpr explicit ByteWriter(std::span<std::uint8_t> buffer) : buffer_(buffer) {}

  template <std::unsigned_integral Number>
  constexpr void put(Number number) {
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      ZERORATE_ASSERT(used_ < buffer_.size());
      buffer_[used_++] = static_cast<std::uint8_t>(std::uint64_t{number} >> (8 * i));
    }
  }
  constexpr void put(std::int64_t number) { put(static_cast<std::uint64_t>(number)); }
  /// The bits of the number: nothing is rounded.
  constexpr void put(float number) { put(std::bit_cast<std::uint32_t>(number)); }

  [[nodiscard]] constexpr std::span<const std::uint8_t> written() const {
    return buffer_.first(used_);
  }

 private:
  std::span<std::uint8_t> buffer_;
  std::size_t used_ = 0;
};

/// Takes a buffer apart from the front. Reading beyond its end is a programmer error: check the
/// length first.
class ByteReader {
 public:
  constexpr explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::unsigned_integral Number>
  [[nodiscard]] constexpr Number take() {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      ZERORATE_ASSERT(taken_ < bytes_.size());
      number |= std::uint64_t{bytes_[taken_++]} << (8 * i);
    }
    return static_cast<Number>(number);
  }
  [[nodiscard]] constexpr std::int64_t take_int64() {
    return static_cast<std::int64_t>(take<std::uint64_t>());
  }
  [[nodiscard]] constexpr float take_float() { return std::bit_cast<float>(take<std::uint32_t>()); }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t taken_ = 0;
};

}  // namespace zerorate::wire

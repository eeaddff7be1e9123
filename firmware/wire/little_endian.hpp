/// @file
/// Numbers as bytes, lowest first, on every processor.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"

namespace zerorate::wire {

/// Appends numbers to a buffer of fixed size.
class LittleEndianWriter {
 public:
  constexpr explicit LittleEndianWriter(std::span<std::uint8_t> target) : rest_(target) {}

  template <std::unsigned_integral Number>
  constexpr void put(Number number) {
    ZERORATE_ASSERT(rest_.size() >= sizeof(Number));
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      rest_[i] = static_cast<std::uint8_t>(number >> (8U * i));
    }
    rest_ = rest_.subspan(sizeof(Number));
  }
  /// IEEE 754 single precision.
  constexpr void put(float number) { put(std::bit_cast<std::uint32_t>(number)); }

 private:
  std::span<std::uint8_t> rest_;
};

/// Takes numbers from the front of a buffer.
class LittleEndianReader {
 public:
  constexpr explicit LittleEndianReader(std::span<const std::uint8_t> source) : rest_(source) {}

  template <std::unsigned_integral Number>
  [[nodiscard]] constexpr Number take() {
    ZERORATE_ASSERT(rest_.size() >= sizeof(Number));
    Number number = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      number = static_cast<Number>(number | static_cast<Number>(Number{rest_[i]} << (8U * i)));
    }
    rest_ = rest_.subspan(sizeof(Number));
    return number;
  }
  [[nodiscard]] constexpr float take_float() { return std::bit_cast<float>(take<std::uint32_t>()); }

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace zerorate::wire

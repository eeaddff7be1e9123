/// @file
/// Signals of a CAN frame, bit after bit in Intel order (`@1` of a DBC file), on every processor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"

namespace zerorate::wire {

/// Appends signals of any width to a frame whose bytes are 0.
class CanBitWriter {
 public:
  constexpr explicit CanBitWriter(std::span<std::uint8_t> frame) : frame_(frame) {}

  /// @param bits  width of the signal, at most 32; of the content, the lowest bits are sent
  constexpr void put(std::uint32_t content, std::size_t bits) {
    ZERORATE_ASSERT(bits <= 32 && at_ + bits <= 8 * frame_.size());
    for (std::size_t i = 0; i < bits; ++i, ++at_) {
      const unsigned bit = (content >> i) & 1U;
      frame_[at_ / 8] = static_cast<std::uint8_t>(frame_[at_ / 8] | bit << (at_ % 8));
    }
  }

 private:
  std::span<std::uint8_t> frame_;
  std::size_t at_ = 0;
};

/// Content for "not available" of a signal with a sign: its lowest.
[[nodiscard]] constexpr std::uint32_t can_not_available_signed(std::size_t bits) {
  return std::uint32_t{1} << (bits - 1);
}
/// Content for "not available" of a signal without a sign: all bits set.
[[nodiscard]] constexpr std::uint32_t can_not_available_unsigned(std::size_t bits) {
  return 0xFFFFFFFFU >> (32 - bits);
}

namespace detail {
/// Limit of the magnitude of a signal of so many bits, rounded down to what single precision can
/// represent, so that a count below it fits.
[[nodiscard]] constexpr float greatest_can_count(std::size_t bits) {
  constexpr std::size_t kMantissa = 24;
  const std::uint32_t all = can_not_available_unsigned(bits);
  const std::size_t lost = bits > kMantissa ? bits - kMantissa : 0;
  return static_cast<float>(all >> lost << lost);
}
/// The nearest whole number, ties away from zero.
[[nodiscard]] constexpr std::uint32_t nearest_count(float count) {
  return static_cast<std::uint32_t>(
      static_cast<std::int32_t>(count < 0.0F ? count - 0.5F : count + 0.5F));
}
}  // namespace detail

/// Signal with a sign: the nearest count of its LSB; not available where the count does not fit.
[[nodiscard]] constexpr std::uint32_t encode_can_signed(float count, std::size_t bits) {
  const float limit = detail::greatest_can_count(bits - 1);
  if (!(count > -limit && count < limit)) return can_not_available_signed(bits);
  return detail::nearest_count(count);
}
/// Signal without a sign, of at most 31 bits; not available where the count does not fit.
[[nodiscard]] constexpr std::uint32_t encode_can_unsigned(float count, std::size_t bits) {
  const float limit = detail::greatest_can_count(bits) - 1.0F;
  if (!(count >= 0.0F && count < limit)) return can_not_available_unsigned(bits);
  return detail::nearest_count(count);
}

}  // namespace zerorate::wire

/// @file
/// Frames on a stream of bytes, such as a serial line: consistent overhead byte stuffing.
///
/// The method is that of Cheshire and Baker 1999.
/// A zero byte ends a frame and stands nowhere else, so that a receiver that joins in the middle,
/// or that missed bytes, is in step again after the next zero.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/assert.hpp"

namespace zerorate::wire {

/// Bytes that a frame of this size needs at most, the zero at its end included.
[[nodiscard]] constexpr std::size_t cobs_bytes(std::size_t frame) {
  return frame + frame / 254 + 2;
}

/// Stuffs a frame and ends it with a zero.
/// @param target at least cobs_bytes(frame.size())
/// @return how many bytes were written
[[nodiscard]] constexpr std::size_t encode_cobs(std::span<const std::uint8_t> frame,
                                                std::span<std::uint8_t> target) {
  ZERORATE_ASSERT(target.size() >= cobs_bytes(frame.size()));
  std::size_t code_at = 0;  // place of the length of the block being filled
  std::size_t used = 1;
  std::uint8_t length = 1;
  for (const std::uint8_t byte : frame) {
    if (byte != 0) {
      target[used++] = byte;
      ++length;
    }
    if (byte == 0 || length == 0xFF) {
      target[code_at] = length;
      code_at = used++;
      length = 1;
    }
  }
  target[code_at] = length;
  target[used++] = 0;
  return used;
}

/// Takes a stream byte by byte and gives the frames in it.
/// @tparam Longest  frames of more bytes than this are dropped
template <std::size_t Longest>
class CobsReader {
 public:
  /// The frame that this byte ends, valid until the next call; none as long as it goes on, and none
  /// for one that is damaged or too long, which counts as dropped.
  constexpr std::optional<std::span<const std::uint8_t>> take(std::uint8_t byte) {
    if (byte == 0) return end_frame();
    if (left_in_block_ == 0) {
      begin_block(byte);
    } else {
      push(byte);
      --left_in_block_;
    }
    return std::nullopt;
  }

  [[nodiscard]] constexpr std::uint32_t dropped() const { return dropped_; }

 private:
  constexpr void begin_block(std::uint8_t length) {
    if (zero_before_block_) push(0);
    zero_before_block_ = length != 0xFF;  // a full block stands for 254 bytes without a zero
    left_in_block_ = static_cast<std::uint8_t>(length - 1);
    began_ = true;
  }

  constexpr void push(std::uint8_t byte) {
    if (used_ < Longest) frame_[used_] = byte;
    if (used_ <= Longest) ++used_;
  }

  constexpr std::optional<std::span<const std::uint8_t>> end_frame() {
    const bool is_whole = began_ && left_in_block_ == 0 && used_ <= Longest;
    const std::size_t size = used_;
    if (began_ && !is_whole) ++dropped_;
    used_ = 0;
    left_in_block_ = 0;
    zero_before_block_ = false;
    began_ = false;
    if (!is_whole) return std::nullopt;
    return std::span<const std::uint8_t>{frame_}.first(size);
  }

  std::array<std::uint8_t, Longest> frame_{};
  std::size_t used_ = 0;  // Longest + 1: too long
  std::uint8_t left_in_block_ = 0;
  bool zero_before_block_ = false;
  bool began_ = false;
  std::uint32_t dropped_ = 0;
};

}  // namespace zerorate::wire

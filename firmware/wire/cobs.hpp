/// @file
/// Consistent overhead byte stuffing: frames on a line that knows only bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/assert.hpp"

namespace zerorate::wire {

/// S. Cheshire and M. Baker, "Consistent Overhead Byte Stuffing", IEEE/ACM Trans. Networking 7
/// (1999): no zero inside, one zero after each frame, so that a reader who comes late or lost a
/// byte is in step again at the next zero. Costs one byte in 254, and the zero.
template <std::size_t FrameBytes>
inline constexpr std::size_t kStuffedBytes = FrameBytes + FrameBytes / 254 + 2;

/// @param stuffed at least kStuffedBytes of the frame's size
/// @return how many bytes were written, the final zero included
constexpr std::size_t stuff(std::span<const std::uint8_t> frame, std::span<std::uint8_t> stuffed) {
  ZERORATE_ASSERT(stuffed.size() >= frame.size() + frame.size() / 254 + 2);
  constexpr std::uint8_t kLongestGroup = 0xFF;
  std::size_t group = 0;  // where the length of the group being written belongs
  std::uint8_t length = 1;
  std::size_t next = 1;
  const auto close_group = [&] {
    stuffed[group] = length;
    group = next++;
    length = 1;
  };
  for (const std::uint8_t byte : frame) {
    if (length == kLongestGroup) close_group();
    if (byte == 0) {
      close_group();
    } else {
      stuffed[next++] = byte;
      ++length;
    }
  }
  stuffed[group] = length;
  stuffed[next++] = 0;
  return next;
}

/// Finds the frames in a stream of bytes.
/// @tparam LongestFrame what is longer is no frame of ours and is dropped
template <std::size_t LongestFrame>
class CobsReader {
 public:
  /// Takes one byte. If a frame ended with it: the frame, valid until the next call.
  constexpr std::optional<std::span<const std::uint8_t>> take(std::uint8_t byte) {
    if (byte == 0) return end_frame();
    if (left_in_group_ == 0) {
      if (owes_zero_) append(0);
      left_in_group_ = byte;
      owes_zero_ = byte != 0xFF;
    } else {
      append(byte);
    }
    --left_in_group_;
    return std::nullopt;
  }

  /// Pieces between two zeros that were no frame: too long, or cut off.
  [[nodiscard]] constexpr std::uint32_t dropped() const { return dropped_; }

 private:
  constexpr void append(std::uint8_t byte) {
    if (used_ < frame_.size()) frame_[used_] = byte;
    ++used_;
  }
  constexpr std::optional<std::span<const std::uint8_t>> end_frame() {
    const std::size_t size = used_;
    const bool is_cut = left_in_group_ > 0;
    used_ = 0;
    left_in_group_ = 0;
    owes_zero_ = false;
    if (size == 0 && !is_cut) return std::nullopt;  // zeros between frames are harmless
    if (is_cut || size > frame_.size()) {
      ++dropped_;
      return std::nullopt;
    }
    return std::span<const std::uint8_t>{frame_}.first(size);
  }

  std::array<std::uint8_t, LongestFrame> frame_{};
  std::size_t used_ = 0;
  std::uint32_t dropped_ = 0;
  std::uint8_t left_in_group_ = 0;
  bool owes_zero_ = false;  ///< the group that ended stands for a zero, unless the frame ends too
};

}  // namespace zerorate::wire

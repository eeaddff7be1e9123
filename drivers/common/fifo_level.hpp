/// @file
/// Level of a FIFO that counts bytes.
#pragma once

#include <cstdint>

namespace zerorate::drivers {

struct FifoLevel {
  std::uint16_t frames;  ///< complete frames that wait
  bool is_whole;         ///< there are no bytes beside them
  bool is_overrun;       ///< frames were lost, or are about to be
  bool is_plausible;     ///< the FIFO can contain so much
};

/// Room for three frames is kept free: they may come while the FIFO is read, and not every chip
/// shows that it dropped the oldest.
/// @param bytes  in the FIFO
/// @param frame_bytes  of each frame
/// @param fifo_bytes  that the FIFO has at least
/// @param most_bytes  that it has at most
[[nodiscard]] constexpr FifoLevel fifo_level(unsigned bytes, unsigned frame_bytes,
                                             unsigned fifo_bytes, unsigned most_bytes) {
  return {static_cast<std::uint16_t>(bytes / frame_bytes), bytes % frame_bytes == 0,
          bytes + 3 * frame_bytes > fifo_bytes, bytes <= most_bytes};
}
/// Level of a FIFO whose size is known.
[[nodiscard]] constexpr FifoLevel fifo_level(unsigned bytes, unsigned frame_bytes,
                                             unsigned fifo_bytes) {
  return fifo_level(bytes, frame_bytes, fifo_bytes, fifo_bytes);
}

}  // namespace zerorate::drivers

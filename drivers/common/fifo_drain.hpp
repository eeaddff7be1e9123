/// @file
/// Reading the frames that wait in a chip's FIFO.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "drivers/common/driver_error.hpp"
#include "drivers/common/gyro_source.hpp"
#include "drivers/common/register_access.hpp"

namespace zerorate::drivers {

/// Kind of a frame that was read.
enum class Frame : std::uint8_t { sample, no_sample, corrupt };

/// Reads frames until out is full or so many were read; one transaction for every 16.
/// @param data the register through which the FIFO is read; a burst stays on it
/// @param frame_bytes of each frame, at most MostBytes
/// @param waiting complete frames in the FIFO
/// @param decode (span<const uint8_t>, GyroSample&) -> Frame, called for every frame that is read,
///        in the order of the FIFO
/// @return samples in out; or the bus's error, or corrupt_data at the first corrupt frame
template <std::size_t MostBytes, RegisterBus Bus, class DataRegister, class Decode>
core::Result<std::size_t, DriverError> drain_frames(Bus& bus, DataRegister data,
                                                    std::size_t frame_bytes, std::size_t waiting,
                                                    std::span<GyroSample> out, Decode decode) {
  constexpr std::size_t kBurstFrames = 16;
  std::size_t count = 0;
  while (waiting > 0 && count < out.size()) {
    std::array<std::uint8_t, kBurstFrames * MostBytes> bytes{};
    const std::size_t burst = std::min({kBurstFrames, waiting, out.size() - count});
    const auto used = std::span{bytes}.first(burst * frame_bytes);
    if (const auto done = read_registers(bus, data, used); !done) {
      return core::Unexpected{done.error()};
    }
    waiting -= burst;
    for (auto rest = used; !rest.empty(); rest = rest.subspan(frame_bytes)) {
      const Frame frame = decode(rest.first(frame_bytes), out[count]);
      if (frame == Frame::corrupt) return refused(DriverErrorCode::corrupt_data, data.address);
      if (frame == Frame::sample) ++count;
    }
  }
  return count;
}

/// drain_frames() for frames whose size the compiler knows.
/// @param decode (span<const uint8_t, FrameBytes>, GyroSample&) -> Frame
template <std::size_t FrameBytes, RegisterBus Bus, class DataRegister, class Decode>
core::Result<std::size_t, DriverError> drain_fifo(Bus& bus, DataRegister data, std::size_t waiting,
                                                  std::span<GyroSample> out, Decode decode) {
  return drain_frames<FrameBytes>(bus, data, FrameBytes, waiting, out,
                                  [&](std::span<const std::uint8_t> frame, GyroSample& sample) {
                                    return decode(std::span<const std::uint8_t, FrameBytes>{frame},
                                                  sample);
                                  });
}

/// Finds frames without a mark that a transfer did not read: all bits are 1 or all are 0 on all
/// axes, and the frame before was far from that. They count where the next reading has them too:
/// the driver asks for the identity behind each, and a dead line would have shown.
class BlankFrames {
 public:
  using Raw = std::array<std::int16_t, 3>;

  constexpr void begin_reading() {
    were_blank_ = are_blank_;
    are_blank_ = false;
  }
  /// @return whether the frame was not read
  constexpr bool is_blank(const Raw& raw) {
    const bool is_uniform = raw[0] == raw[1] && raw[1] == raw[2] && (raw[0] == 0 || raw[0] == -1);
    if (is_uniform && has_newest_ && is_far(raw)) {
      are_blank_ = true;
      if (!were_blank_) return true;
    }
    newest_ = raw;
    has_newest_ = true;
    return false;
  }
  constexpr void restart() { *this = {}; }

 private:
  [[nodiscard]] constexpr bool is_far(const Raw& raw) const {
    constexpr int kNear = 8;  // counts, as noise is
    bool is_far = false;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const int step = raw[i] - newest_[i];
      is_far |= step > kNear || step < -kNear;
    }
    return is_far;
  }

  Raw newest_{};
  bool has_newest_ = false;
  bool are_blank_ = false;   ///< frames of this reading
  bool were_blank_ = false;  ///< frames of the one before
};

/// Lets one overrun be reported once. The error is reported instead of samples, so the FIFO is as
/// full as before when the next reading comes, and a chip that went on meanwhile reports an overrun
/// again: that is the same gap, and the reading has to drain the FIFO, or it would never end.
class OverrunReport {
 public:
  /// @param says_overrun overrun flag of the chip at this reading
  /// @return true if the reading is to report it
  constexpr bool is_due(bool says_overrun) {
    is_reported_ = says_overrun && !is_reported_;
    return is_reported_;
  }

 private:
  bool is_reported_ = false;
};

}  // namespace zerorate::drivers

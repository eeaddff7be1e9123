/// @file
/// Output of the node on its serial line: frames for programs, or lines for people.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "firmware/app/node_loop.hpp"
#include "firmware/app/rate_message.hpp"
#include "firmware/wire/cobs.hpp"
#include "firmware/wire/rate_frame.hpp"
#include "firmware/wire/rate_text.hpp"
#include "firmware/wire/status_frame.hpp"

namespace zerorate::boards {

/// A RateSink. A message for which the line has no room is dropped whole and counted; its number is
/// used up, so that the reader sees the gap.
/// @tparam Line has `bool send(std::span<const std::uint8_t>)`, all or nothing
template <class Line>
class Console {
 public:
  explicit Console(Line& line) : line_(line) {}

  /// Takes a typed key: 't' selects text, 'b' frames; other keys do nothing.
  void handle_key(char key) {
    if (key == 't') is_text_ = true;
    if (key == 'b') is_text_ = false;
  }

  /// Not inlined: the main loop does not keep room for its frame while the node computes.
  [[gnu::noinline]] void publish(const app::RateMessage& message) {
    const std::uint32_t sequence = sequence_++;
    if (is_text_) {
      wire::TextLine text;
      send(wire::write_rate(message, text));
    } else {
      const wire::RateFrame frame = wire::encode_rate_frame(sequence, message);
      send_frame<wire::kMostRateFrameBytes>(frame.bytes());
    }
  }

  /// Likewise.
  [[gnu::noinline]] void report(const app::LoopCounters& counters) {
    if (is_text_) return;
    send_frame<wire::kStatusFrameBytes>(wire::encode_status_frame({counters, dropped_}));
  }

 private:
  template <std::size_t Most>
  void send_frame(std::span<const std::uint8_t> frame) {
    std::array<std::uint8_t, wire::cobs_bytes(Most)> stuffed{};
    send(std::span{stuffed}.first(wire::encode_cobs(frame, stuffed)));
  }
  void send(std::span<const std::uint8_t> bytes) {
    if (!line_.send(bytes)) ++dropped_;
  }

  Line& line_;
  std::uint32_t sequence_ = 0;
  std::uint32_t dropped_ = 0;
  bool is_text_ = false;
};

}  // namespace zerorate::boards

/// @file
/// Messages on their way from the measuring thread to the publishing one.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/boards/linux/process/event.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::linux_node {

/// A RateSink for one writing thread, read by one other. Numbers the messages, so that what does
/// not fit shows as a gap to every receiver; it is counted too. Neither side ever waits for the
/// other.
class MessageQueue {
 public:
  static constexpr std::size_t kCapacity = 2048;  ///< two seconds at 1 kHz

  // The writing thread's side.
  void publish(const app::RateMessage& message) {
    const std::uint32_t sequence = sequence_++;
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == kCapacity) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    messages_[end % kCapacity] = {.sequence = sequence, .message = message};
    end_.store(end + 1, std::memory_order_release);
    waiting_.signal();
  }

  // The reading thread's side.
  [[nodiscard]] std::optional<wire::NumberedMessage> take() {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return std::nullopt;
    const wire::NumberedMessage message = messages_[begin % kCapacity];
    begin_.store(begin + 1, std::memory_order_release);
    return message;
  }
  /// Readable once there is a message; clear() it before taking.
  [[nodiscard]] const Event& waiting() const { return waiting_; }
  [[nodiscard]] std::uint32_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::array<wire::NumberedMessage, kCapacity> messages_{};
  std::atomic<std::size_t> begin_ = 0;
  std::atomic<std::size_t> end_ = 0;
  std::atomic<std::uint32_t> dropped_ = 0;
  std::uint32_t sequence_ = 0;
  Event waiting_;
};
static_assert(app::RateSink<MessageQueue>);

}  // namespace zerorate::linux_node

/// @file
/// Bytes on their way from the main loop to the interrupt that sends them.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace zerorate::hal::cortex_m {

/// A queue with one writer, the main loop, and one reader, a handler.
/// @tparam Capacity power of two
template <std::size_t Capacity>
class ByteQueue {
  static_assert((Capacity & (Capacity - 1)) == 0, "indices wrap at a power of two");

 public:
  /// Takes all of the bytes or, if there is no room for all, none.
  bool push(std::span<const std::uint8_t> bytes) {
    std::uint32_t written = written_.load(std::memory_order_relaxed);
    if (bytes.size() > Capacity - (written - taken_.load(std::memory_order_acquire))) return false;
    for (const std::uint8_t byte : bytes) bytes_[written++ % Capacity] = byte;
    written_.store(written, std::memory_order_release);
    return true;
  }

  /// For the handler.
  [[nodiscard]] bool is_empty() const {
    return taken_.load(std::memory_order_relaxed) == written_.load(std::memory_order_acquire);
  }
  /// Sends the oldest bytes while there is room for one more. For the handler.
  void drain(auto has_room, auto send) {
    std::uint32_t taken = taken_.load(std::memory_order_relaxed);
    const std::uint32_t written = written_.load(std::memory_order_acquire);
    while (taken != written && has_room()) send(bytes_[taken++ % Capacity]);
    taken_.store(taken, std::memory_order_release);
  }

 private:
  std::array<std::uint8_t, Capacity> bytes_{};
  std::atomic<std::uint32_t> written_{0};
  std::atomic<std::uint32_t> taken_{0};
};

}  // namespace zerorate::hal::cortex_m

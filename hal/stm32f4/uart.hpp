/// @file
/// USART 2 (PA2 out, PA3 in): a queue out, single characters in.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/stm32f4/chip.hpp"

namespace zerorate::hal::stm32f4 {

/// 8 bits, no parity, one stop bit. send() never waits: the interrupt (usart_2) takes from the
/// queue.
/// @tparam Capacity of the queue, power of two
template <std::size_t Capacity>
class Usart2 {
  static_assert((Capacity & (Capacity - 1)) == 0, "indices wrap at a power of two");

 public:
  static void start(std::uint32_t apb1_hz, std::uint32_t baud) {
    rcc::kApb1Enable.set(rcc::kUsart2);
    usart2::kBaud.write((apb1_hz + baud / 2) / baud);
    usart2::kControl.write(usart2::kEnableBothWays);
    connect<0, 2>(PinMode::function, Pull::none, kFunction);
    connect<0, 3>(PinMode::function, Pull::up, kFunction);
  }

  /// Queues all of the bytes or, if there is no room for all, none.
  bool send(std::span<const std::uint8_t> bytes) {
    std::uint32_t written = written_.load(std::memory_order_relaxed);
    if (bytes.size() > Capacity - (written - sent_.load(std::memory_order_acquire))) return false;
    for (const std::uint8_t byte : bytes) queue_[written++ % Capacity] = byte;
    written_.store(written, std::memory_order_release);
    usart2::kControl.write(usart2::kEnableBothWays | usart2::kTransmitInterrupt);
    return true;
  }

  /// The handler of usart_2: one byte; the interrupt is off once the queue is empty.
  void on_interrupt() {
    const std::uint32_t sent = sent_.load(std::memory_order_relaxed);
    if (sent == written_.load(std::memory_order_acquire)) {
      usart2::kControl.write(usart2::kEnableBothWays);
    } else if ((usart2::kStatus.read() & usart2::kTransmitEmpty) != 0) {
      usart2::kData.write(queue_[sent % Capacity]);
      sent_.store(sent + 1, std::memory_order_release);
    }
  }

  /// A character that was received, if any.
  static std::optional<char> receive() {
    if ((usart2::kStatus.read() & usart2::kReceived) == 0) return std::nullopt;
    return static_cast<char>(usart2::kData.read() & 0xFFU);
  }

 private:
  static constexpr std::uint32_t kFunction = 7;

  std::array<std::uint8_t, Capacity> queue_{};
  std::atomic<std::uint32_t> written_{0};
  std::atomic<std::uint32_t> sent_{0};
};

}  // namespace zerorate::hal::stm32f4

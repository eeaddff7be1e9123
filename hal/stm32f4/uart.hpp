/// @file
/// USART 2 (PA2 out, PA3 in): a queue out, single characters in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/cortex_m/byte_queue.hpp"
#include "hal/stm32f4/chip.hpp"

namespace zerorate::hal::stm32f4 {

/// 8 bits, no parity, one stop bit. send() never waits: the interrupt (usart_2) takes from the
/// queue.
/// @tparam Capacity of the queue, power of two
template <std::size_t Capacity>
class Usart2 {
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
    if (!queue_.push(bytes)) return false;
    usart2::kControl.write(usart2::kEnableBothWays | usart2::kTransmitInterrupt);
    return true;
  }

  /// The handler of usart_2; the interrupt is off once the queue is empty.
  void on_interrupt() {
    if (queue_.is_empty()) usart2::kControl.write(usart2::kEnableBothWays);
    queue_.drain([] { return (usart2::kStatus.read() & usart2::kTransmitEmpty) != 0; },
                 [](std::uint8_t byte) { usart2::kData.write(byte); });
  }

  /// A character that was received, if any.
  static std::optional<char> receive() {
    if ((usart2::kStatus.read() & usart2::kReceived) == 0) return std::nullopt;
    return static_cast<char>(usart2::kData.read() & 0xFFU);
  }

 private:
  static constexpr std::uint32_t kFunction = 7;

  cortex_m::ByteQueue<Capacity> queue_;
};

}  // namespace zerorate::hal::stm32f4

/// @file
/// UART 0 (Arm PL011): a queue out, single characters in.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/cortex_m/byte_queue.hpp"
#include "hal/cortex_m/registers.hpp"
#include "hal/rp2040/chip.hpp"
#include "hal/rp2040/registers.hpp"

namespace zerorate::hal::rp2040 {

/// 8 bits, no parity, one stop bit. send() never waits: the interrupt (uart0) feeds the FIFO.
/// @tparam Capacity of the queue, power of two
template <unsigned TransmitPin, unsigned ReceivePin, std::size_t Capacity>
class Uart0 {
 public:
  static void start(std::uint32_t baud) {
    release_from_reset(resets::kUart0);
    const std::uint32_t divider_64ths = (kClockHz * 4U + baud / 2) / baud;  // clk / (16 baud)
    uart0::kBaudInteger.write(divider_64ths / 64);
    uart0::kBaudFraction.write(divider_64ths % 64);
    uart0::kLineControl.write(uart0::kFifosEnabled8Bits);  // takes the divider over (4.2.7.1)
    uart0::kControl.write(uart0::kEnableBothWays);
    uart0::kInterruptMask.write(uart0::kTransmitInterrupt);
    connect<TransmitPin>(io_bank0::uart);
    connect<ReceivePin>(io_bank0::uart, Pull::up);
  }

  /// Queues all of the bytes or, if there is no room for all, none.
  bool send(std::span<const std::uint8_t> bytes) {
    if (!queue_.push(bytes)) return false;
    // The handler is the only one who touches the FIFO, so it is called even for the first byte.
    cortex_m::nvic::kSetPending<nvic::uart0>.write(bit(nvic::uart0));
    return true;
  }

  /// The handler of uart0. The FIFO interrupts when it drains past its mark, so that a full one
  /// always calls again (PL011 manual, DDI 0183, section 2.8.2).
  void on_interrupt() {
    uart0::kInterruptClear.write(uart0::kTransmitInterrupt);
    queue_.drain([] { return (uart0::kFlags.read() & uart0::kTransmitFull) == 0; },
                 [](std::uint8_t byte) { uart0::kData.write(byte); });
  }

  /// A character that was received, if any.
  static std::optional<char> receive() {
    if ((uart0::kFlags.read() & uart0::kReceiveEmpty) != 0) return std::nullopt;
    return static_cast<char>(uart0::kData.read() & 0xFFU);
  }

 private:
  cortex_m::ByteQueue<Capacity> queue_;
};

}  // namespace zerorate::hal::rp2040

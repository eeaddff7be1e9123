/// @file
/// A device on SPI 1 (PA5 clock, PA6 in, PA7 out), chip select on PA4 included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "hal/contract/spi_device.hpp"
#include "hal/stm32f4/chip.hpp"
#include "hal/stm32f4/timer.hpp"

namespace zerorate::hal::stm32f4 {

/// An SpiDevice in mode 3, 8 bits, most significant first. Chip select is driven by software.
class Spi1Device {
 public:
  /// @param highest_hz the clock is the next one below it that the divider reaches
  static void start(std::uint32_t apb2_hz, std::uint32_t highest_hz) {
    rcc::kApb2Enable.set(rcc::kSpi1);
    std::uint32_t power = 0;  // a division by 2^(power + 1)
    while (power < 7 && (apb2_hz >> (power + 1)) > highest_hz) ++power;
    spi1::kControl1.write(spi1::kSecondEdge | spi1::kIdlesHigh | spi1::kController | (power << 3U) |
                          spi1::kSelectedBySoftware | spi1::kEnable);
    select(false);
    connect<0, 4>(PinMode::output, Pull::none);
    connect<0, 5>(PinMode::function, Pull::none, kFunction);
    connect<0, 6>(PinMode::function, Pull::none, kFunction);
    connect<0, 7>(PinMode::function, Pull::none, kFunction);
  }

  /// Blocks for the transfer; timeout after 1 ms, which is 650 bytes at 5.25 MHz.
  static core::Result<void, BusError> transaction(std::span<const Operation> operations) {
    if (operations.empty()) return {};
    const Deadline deadline{1000};
    select(true);
    bool is_done = true;
    for (const Operation& operation : operations) {
      is_done = is_done && transfer(operation, deadline);
    }
    is_done = is_done && waited_while(spi1::kBusy, spi1::kBusy, deadline);
    select(false);
    if (!is_done) return core::Unexpected{BusError::timeout};
    return {};
  }

 private:
  static constexpr std::uint32_t kFunction = 5;

  static void select(bool is_selected) {
    gpio::kSetReset<0>.write(is_selected ? bit(4 + 16) : bit(4));
  }
  /// Waits while the bits of a mask have a value.
  static bool waited_while(std::uint32_t mask, std::uint32_t value, const Deadline& deadline) {
    while ((spi1::kStatus.read() & mask) == value) {
      if (deadline.is_over()) return false;
    }
    return true;
  }
  /// Byte by byte: there is no FIFO.
  static bool transfer(const Operation& operation, const Deadline& deadline) {
    const auto bytes = operation.bytes();
    const auto buffer = operation.buffer();
    for (std::size_t i = 0; i < operation.size(); ++i) {
      if (!waited_while(spi1::kTransmitEmpty, 0, deadline)) return false;
      spi1::kData.write(bytes.empty() ? 0U : bytes[i]);
      if (!waited_while(spi1::kReceived, 0, deadline)) return false;
      const auto byte = static_cast<std::uint8_t>(spi1::kData.read());
      if (!buffer.empty()) buffer[i] = byte;
    }
    return true;
  }
};
static_assert(SpiDevice<Spi1Device>);

}  // namespace zerorate::hal::stm32f4

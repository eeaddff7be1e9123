/// @file
/// A simulated chip of 32-bit frames as an SPI device.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "hal/contract/spi_device.hpp"

namespace zerorate::hal::sim {

/// - `exchange_frame(command)` takes a command and gives the reply to the one before
template <class Chip>
concept FrameChip = requires(Chip& chip, std::uint32_t command) {
  { chip.exchange_frame(command) } -> std::same_as<std::uint32_t>;
};

/// An SpiDevice: one exchange of four bytes under chip select is a frame. The reply is on the wire
/// before the command is known, so what is sent is heard only at the end. A selection with another
/// number of clocks is no frame: the chip gives ones and does not react.
template <FrameChip Chip>
class SimulatedFrameSpi {
 public:
  explicit SimulatedFrameSpi(Chip& chip) : chip_(&chip) {}

  core::Result<void, BusError> transaction(std::span<const Operation> operations) {
    if (operations.empty()) return {};
    const bool is_frame = operations.size() == 1 && operations[0].size() == kBytes;
    std::uint32_t command = 0;
    if (is_frame) {
      for (const std::uint8_t byte : operations[0].bytes()) command = (command << 8U) | byte;
    }
    std::uint32_t reply = is_frame ? chip_->exchange_frame(command) : 0xFFFF'FFFF;
    for (const Operation& operation : operations) {
      for (std::uint8_t& byte : operation.buffer()) {
        byte = static_cast<std::uint8_t>(reply >> 24U);
        reply = (reply << 8U) | 0xFFU;
      }
    }
    return {};
  }

 private:
  static constexpr std::size_t kBytes = 4;
  Chip* chip_;
};

}  // namespace zerorate::hal::sim

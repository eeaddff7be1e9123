/// @file
/// A simulated chip as an SPI device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/result.hpp"
#include "hal/contract/spi_device.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// An SpiDevice: while selected, the first byte is the address with bit 7 set to read; every byte
/// after it is data.
template <RegisterChip Chip>
class SimulatedSpiDevice {
 public:
  explicit SimulatedSpiDevice(Chip& chip) : chip_(&chip) {}

  core::Result<void, BusError> transaction(std::span<const Operation> operations) {
    command_.reset();  // chip select falls
    for (const Operation& operation : operations) {
      for (std::size_t i = 0; i < operation.size(); ++i) {
        const std::uint8_t received = exchange(operation.is_read() ? 0x00 : operation.bytes()[i]);
        if (!operation.buffer().empty()) operation.buffer()[i] = received;
      }
    }
    return {};
  }

 private:
  static constexpr std::uint8_t kRead = 0x80;

  std::uint8_t exchange(std::uint8_t sent) {
    if (!command_) {
      command_ = sent;
      return kUndriven;
    }
    const auto address = static_cast<std::uint8_t>(*command_ & ~kRead);
    const auto direction = static_cast<std::uint8_t>(*command_ & kRead);
    command_ = static_cast<std::uint8_t>(chip_->next_address(address) | direction);
    if (direction == kRead) return chip_->read_register(address);
    chip_->write_register(address, sent);
    return kUndriven;
  }

  static constexpr std::uint8_t kUndriven = 0xFF;  // a pulled-up line while the chip listens
  Chip* chip_;
  std::optional<std::uint8_t> command_;  // address of the next byte and the read bit
};

}  // namespace zerorate::hal::sim

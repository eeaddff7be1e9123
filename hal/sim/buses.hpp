/// @file
/// A simulated chip on its bus: as an SPI device, with registers, with 32-bit frames or with 16-bit
/// words, or as the only device of an I2C bus.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "hal/contract/i2c_bus.hpp"
#include "hal/contract/spi_device.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// Bytes without meaning that a chip sends before what is read.
template <RegisterChip Chip>
inline constexpr std::size_t kSpiDummies = [] {
  if constexpr (requires { Chip::kSpiDummies; }) {
    return Chip::kSpiDummies;
  } else {
    return std::size_t{0};
  }
}();

/// An SpiDevice: while selected, the first byte is the address with bit 7 set to read; every byte
/// after it is data.
/// @tparam kDummies  bytes without meaning before what is read, as some dies send them
template <RegisterChip Chip, std::size_t kDummies = kSpiDummies<Chip>>
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
      dummies_ = (sent & kRead) != 0 ? kDummies : 0;
      return kUndriven;
    }
    if (dummies_ > 0) {
      --dummies_;
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
  std::size_t dummies_ = 0;              // still to come
};

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

/// - `select()` as chip select falls
/// - `reply()` gives the word that is on the wire next
/// - `take(word)` takes what was sent meanwhile
/// - `refuse_clocks()` for a selection that was no whole number of words
template <class Chip>
concept WordChip = requires(Chip& chip, std::uint16_t word) {
  { chip.select() } -> std::same_as<void>;
  { chip.reply() } -> std::same_as<std::uint16_t>;
  { chip.take(word) } -> std::same_as<void>;
  { chip.refuse_clocks() } -> std::same_as<void>;
};

/// An SpiDevice: every two bytes under chip select are a word. The reply is on the wire before the
/// word is known, so what is sent is heard only at its end.
template <WordChip Chip>
class SimulatedWordSpi {
 public:
  explicit SimulatedWordSpi(Chip& chip) : chip_(&chip) {}

  core::Result<void, BusError> transaction(std::span<const Operation> operations) {
    if (operations.empty()) return {};
    chip_->select();
    bytes_ = 0;
    for (const Operation& operation : operations) {
      for (std::size_t i = 0; i < operation.size(); ++i) {
        const std::uint8_t received = exchange(operation.is_read() ? 0x00 : operation.bytes()[i]);
        if (!operation.buffer().empty()) operation.buffer()[i] = received;
      }
    }
    if (bytes_ % 2 != 0) chip_->refuse_clocks();
    return {};
  }

 private:
  std::uint8_t exchange(std::uint8_t sent) {
    if (bytes_++ % 2 == 0) {
      reply_ = chip_->reply();
      sent_ = sent;
      return static_cast<std::uint8_t>(reply_ >> 8U);
    }
    chip_->take(static_cast<std::uint16_t>((sent_ << 8U) | sent));
    return static_cast<std::uint8_t>(reply_ & 0xFFU);
  }

  Chip* chip_;
  std::size_t bytes_ = 0;
  std::uint16_t reply_ = 0;
  std::uint8_t sent_ = 0;
};

/// Device of a chip on SPI.
template <class Chip>
struct SpiDeviceOf {
  using Type = SimulatedSpiDevice<Chip>;
};
template <FrameChip Chip>
struct SpiDeviceOf<Chip> {
  using Type = SimulatedFrameSpi<Chip>;
};
template <WordChip Chip>
struct SpiDeviceOf<Chip> {
  using Type = SimulatedWordSpi<Chip>;
};
template <class Chip>
using SimulatedSpi = typename SpiDeviceOf<Chip>::Type;

/// An I2cBus: the first byte written after a START is the register's address; reads go on from it.
/// Any other device address is not acknowledged.
template <RegisterChip Chip>
class SimulatedI2cBus {
 public:
  SimulatedI2cBus(Chip& chip, I2cAddress address) : chip_(&chip), address_(address) {}

  core::Result<void, BusError> transaction(I2cAddress address,
                                           std::span<const Operation> operations) {
    if (!operations.empty() && address != address_) return core::Unexpected{BusError::nack};
    for (const Operation& operation : operations) {
      ZERORATE_ASSERT(!operation.is_exchange());
      bool is_first = true;
      for (const std::uint8_t byte : operation.bytes()) {
        if (is_first) {
          pointer_ = byte;
        } else {
          chip_->write_register(take_pointer(), byte);
        }
        is_first = false;
      }
      for (std::uint8_t& byte : operation.buffer()) byte = chip_->read_register(take_pointer());
    }
    return {};
  }

 private:
  std::uint8_t take_pointer() {
    const std::uint8_t address = pointer_;
    pointer_ = chip_->next_address(address);
    return address;
  }

  Chip* chip_;
  I2cAddress address_;
  std::uint8_t pointer_ = 0;
};

}  // namespace zerorate::hal::sim

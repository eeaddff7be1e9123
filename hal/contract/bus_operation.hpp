/// @file
/// One step of a bus transaction: bytes out, bytes in, or on SPI both at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"

namespace zerorate::hal {

/// A view of bytes to write, of a buffer to read into, or of both; owns nothing.
///
/// A span of Operations is the only argument of a transaction. It maps one to one to an array of
/// `spi_ioc_transfer` for SPI_IOC_MESSAGE(n), to `i2c_msg` for I2C_RDWR, and to one DMA descriptor
/// each on a microcontroller.
class Operation {
 public:
  /// Sends the bytes. They must outlive the transaction.
  [[nodiscard]] static constexpr Operation write(std::span<const std::uint8_t> bytes) {
    return Operation{bytes.data(), nullptr, bytes.size(), Direction::write};
  }
  /// Fills the buffer. On SPI the controller sends 0x00 meanwhile.
  [[nodiscard]] static constexpr Operation read(std::span<std::uint8_t> buffer) {
    return Operation{nullptr, buffer.data(), buffer.size(), Direction::read};
  }
  /// Sends the bytes and meanwhile fills the buffer, which must be of the same size; they may be
  /// the same memory. SPI only: for chips that answer one frame late, with the next question.
  [[nodiscard]] static constexpr Operation exchange(std::span<const std::uint8_t> bytes,
                                                    std::span<std::uint8_t> buffer) {
    ZERORATE_ASSERT(bytes.size() == buffer.size());
    return Operation{bytes.data(), buffer.data(), buffer.size(), Direction::exchange};
  }

  [[nodiscard]] constexpr bool is_read() const { return direction_ == Direction::read; }
  [[nodiscard]] constexpr bool is_exchange() const { return direction_ == Direction::exchange; }
  [[nodiscard]] constexpr std::size_t size() const { return size_; }
  /// The bytes to send; empty for a read.
  [[nodiscard]] constexpr std::span<const std::uint8_t> bytes() const {
    return {bytes_, is_read() ? 0 : size_};
  }
  /// Buffer for the received bytes; empty for a write.
  [[nodiscard]] constexpr std::span<std::uint8_t> buffer() const {
    return {buffer_, direction_ == Direction::write ? 0 : size_};
  }

 private:
  enum class Direction : std::uint8_t { write, read, exchange };

  constexpr Operation(const std::uint8_t* bytes, std::uint8_t* buffer, std::size_t size,
                      Direction direction)
      : bytes_(bytes), buffer_(buffer), size_(size), direction_(direction) {}

  const std::uint8_t* bytes_;
  std::uint8_t* buffer_;
  std::size_t size_;
  Direction direction_;
};

}  // namespace zerorate::hal

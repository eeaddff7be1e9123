/// @file
/// Bus of chips with words of 16 bits, common in Analog Devices' inertial units. The answer to a
/// word comes while the next one is sent.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "hal/contract/bus_operation.hpp"
#include "hal/contract/spi_device.hpp"

namespace zerorate::drivers {

/// Each call is one transaction.
/// - `exchange(word)` sends a word and gives the reply to the word before
/// - `burst(word, out)` sends a word and fills out with what follows under the same selection
template <class Bus>
concept WordBus = requires(Bus& bus, std::uint16_t word, std::span<std::uint8_t> out) {
  { bus.exchange(word) } -> std::same_as<core::Result<std::uint16_t, hal::BusError>>;
  { bus.burst(word, out) } -> std::same_as<core::Result<void, hal::BusError>>;
};

/// Words over SPI, most significant bit first, each under its own chip select. The pause that such
/// chips need between two of them is the back end's (kSpiPause in chip.hpp).
/// Holds a reference: the device must outlive it.
template <hal::SpiDevice Device>
class SpiWords {
 public:
  constexpr explicit SpiWords(Device& device) : device_(&device) {}

  core::Result<std::uint16_t, hal::BusError> exchange(std::uint16_t word) {
    const std::array<std::uint8_t, 2> sent = bytes_of(word);
    std::array<std::uint8_t, 2> got{};
    const std::array operations{hal::Operation::exchange(sent, got)};
    if (const auto done = device_->transaction(operations); !done) {
      return core::Unexpected{done.error()};
    }
    return static_cast<std::uint16_t>((got[0] << 8U) | got[1]);
  }

  core::Result<void, hal::BusError> burst(std::uint16_t word, std::span<std::uint8_t> out) {
    const std::array<std::uint8_t, 2> sent = bytes_of(word);
    const std::array operations{hal::Operation::write(sent), hal::Operation::read(out)};
    return device_->transaction(operations);
  }

 private:
  static constexpr std::array<std::uint8_t, 2> bytes_of(std::uint16_t word) {
    return {static_cast<std::uint8_t>(word >> 8U), static_cast<std::uint8_t>(word & 0xFFU)};
  }

  Device* device_;
};

}  // namespace zerorate::drivers

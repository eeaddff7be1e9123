/// @file
/// Bus of chips with frames of 32 bits, common in automotive sensors. The answer to a frame comes
/// while the next one is sent.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>

#include "core/base/result.hpp"
#include "hal/contract/bus_operation.hpp"
#include "hal/contract/spi_device.hpp"

namespace zerorate::drivers {

/// `exchange(frame)` sends a frame and gives what came meanwhile: the reply to the frame before.
template <class Bus>
concept FrameBus = requires(Bus& bus, std::uint32_t frame) {
  { bus.exchange(frame) } -> std::same_as<core::Result<std::uint32_t, hal::BusError>>;
};

/// Frames over SPI, most significant bit first, each under its own chip select.
/// Holds a reference: the device must outlive it.
template <hal::SpiDevice Device>
class SpiFrames {
 public:
  constexpr explicit SpiFrames(Device& device) : device_(&device) {}

  core::Result<std::uint32_t, hal::BusError> exchange(std::uint32_t frame) {
    const std::array<std::uint8_t, 4> sent{
        static_cast<std::uint8_t>(frame >> 24U), static_cast<std::uint8_t>((frame >> 16U) & 0xFFU),
        static_cast<std::uint8_t>((frame >> 8U) & 0xFFU), static_cast<std::uint8_t>(frame & 0xFFU)};
    std::array<std::uint8_t, 4> got{};
    const std::array operations{hal::Operation::exchange(sent, got)};
    if (const auto done = device_->transaction(operations); !done) {
      return core::Unexpected{done.error()};
    }
    return (std::uint32_t{got[0]} << 24U) | (std::uint32_t{got[1]} << 16U) |
           (std::uint32_t{got[2]} << 8U) | std::uint32_t{got[3]};
  }

 private:
  Device* device_;
};

}  // namespace zerorate::drivers

/// @file
/// A device on SPI 0 (Arm PL022), chip select included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/result.hpp"
#include "hal/contract/spi_device.hpp"
#include "hal/rp2040/chip.hpp"
#include "hal/rp2040/registers.hpp"
#include "hal/rp2040/timer.hpp"

namespace zerorate::hal::rp2040 {

/// Clock idles low and data are taken on the first edge, or high and on the second.
enum class SpiMode : std::uint32_t {
  mode_0 = 0,
  mode_3 = spi0::kClockIdlesHigh | spi0::kSampleOnSecondEdge,
};

/// An SpiDevice in mode 0 or 3, 8 bits, most significant first. Chip select is driven by software:
/// that of the PL022 rises between two bytes (datasheet, 4.4.3).
/// @tparam PauseMicroseconds  shortest time without selection between two transactions; the
///         processor waits for it before each of them
template <unsigned MisoPin, unsigned ChipSelectPin, unsigned ClockPin, unsigned MosiPin,
          std::uint32_t PauseMicroseconds = 0>
class Spi0Device {
 public:
  /// @param highest_hz the clock is the next one below it that the dividers reach
  static void start(std::uint32_t highest_hz, SpiMode mode) {
    release_from_reset(resets::kSpi0);
    constexpr std::uint32_t kPrescale = 2;
    const std::uint32_t divider = (kClockHz / kPrescale + highest_hz - 1) / highest_hz;
    spi0::kPrescale.write(kPrescale);
    spi0::kControl0.write(spi0::kFrames8Bits | static_cast<std::uint32_t>(mode) |
                          ((divider - 1) << 8U));
    spi0::kControl1.write(spi0::kEnable);
    connect_output_high<ChipSelectPin>();
    connect<MisoPin>(io_bank0::spi);
    connect<ClockPin>(io_bank0::spi);
    connect<MosiPin>(io_bank0::spi);
  }

  /// Blocks for the pause and the transfer; timeout after 1 ms more, which is 900 bytes at 7.8 MHz.
  static core::Result<void, BusError> transaction(std::span<const Operation> operations) {
    if (operations.empty()) return {};
    pause();
    const Deadline deadline{1000};
    if (!drain(deadline)) return core::Unexpected{BusError::timeout};
    sio::kOutClear.write(bit(ChipSelectPin));
    bool is_done = true;
    for (const Operation& operation : operations) {
      is_done = is_done && transfer(operation, deadline);
    }
    sio::kOutSet.write(bit(ChipSelectPin));
    if (!is_done) return core::Unexpected{BusError::timeout};
    return {};
  }

 private:
  static constexpr std::size_t kFifoDepth = 8;

  static void pause() {
    if constexpr (PauseMicroseconds > 0) {
      const Deadline over{PauseMicroseconds};
      while (!over.is_over()) {
      }
    }
  }

  /// Keeps the transmit FIFO filled, but never more under way than the receive FIFO holds.
  static bool transfer(const Operation& operation, const Deadline& deadline) {
    const auto bytes = operation.bytes();
    const auto buffer = operation.buffer();
    std::size_t sent = 0;
    std::size_t received = 0;
    while (received < operation.size()) {
      const std::uint32_t status = spi0::kStatus.read();
      if (sent < operation.size() && sent - received < kFifoDepth &&
          (status & spi0::kTransmitNotFull) != 0) {
        spi0::kData.write(bytes.empty() ? 0U : bytes[sent]);
        ++sent;
      } else if ((status & spi0::kReceiveNotEmpty) != 0) {
        const auto byte = static_cast<std::uint8_t>(spi0::kData.read());
        if (!buffer.empty()) buffer[received] = byte;
        ++received;
      } else if (deadline.is_over()) {
        return false;
      }
    }
    return true;
  }

  /// Ends what a transfer that timed out has left in the FIFOs.
  static bool drain(const Deadline& deadline) {
    while ((spi0::kStatus.read() & (spi0::kBusy | spi0::kReceiveNotEmpty)) != 0) {
      spi0::kData.touch();
      if (deadline.is_over()) return false;
    }
    return true;
  }
};
static_assert(SpiDevice<Spi0Device<16, 17, 18, 19>>);

}  // namespace zerorate::hal::rp2040

/// @file
/// One device on an SPI bus, through the kernel's spidev driver.
#pragma once

#include <linux/spi/spidev.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "hal/contract/bus_error.hpp"
#include "hal/contract/bus_operation.hpp"
#include "hal/contract/spi_device.hpp"
#include "hal/linux/device_file.hpp"

namespace zerorate::hal::linux_os {

struct SpiSettings {
  std::string device;                  ///< e.g. "/dev/spidev0.0"
  std::uint32_t speed_hz = 1'000'000;  ///< at most this; the controller takes what it can
  std::uint8_t mode = 3;               ///< 0 to 3: bit 1 is CPOL, bit 0 is CPHA
  core::Duration pause{};              ///< without selection between two transactions, at least
};

/// An SpiDevice: one SPI_IOC_MESSAGE(n) per transaction, so that the kernel holds chip select and
/// the bus from the first operation to the last. Limits of time are the controller driver's.
/// No heap after construction; one system call per transaction (four when the node is opened).
template <class System = SystemCalls>
class SpidevDevice {
 public:
  static constexpr std::size_t kMostOperations = 8;

  explicit SpidevDevice(SpiSettings settings, System system = {})
      : speed_hz_(settings.speed_hz),
        mode_(settings.mode),
        pause_(settings.pause),
        system_(system),
        file_(std::move(settings.device), Subsystem::spi, std::move(system)) {}

  /// @param operations at most kMostOperations; together no more bytes than the kernel's
  ///        spidev.bufsiz (4096 unless set otherwise), else BusError::io
  core::Result<void, BusError> transaction(std::span<const Operation> operations) {
    ZERORATE_ASSERT(operations.size() <= kMostOperations);
    if (operations.empty()) return {};
    if (!file_.is_open()) {
      if (const auto opened = open(); !opened) return opened;
    }
    if (pause_ == core::Duration{}) return transfer(operations);
    system_.wait_until(ended_at_ + pause_);
    const auto done = transfer(operations);
    ended_at_ = system_.now();
    return done;
  }

  /// See DeviceFile.
  [[nodiscard]] int error_number() const { return file_.error_number(); }

 private:
  core::Result<void, BusError> open() {
    if (const auto opened = file_.open(); !opened) return opened;
    if (const auto reserved = file_.reserve(0); !reserved) return reserved;
    for (const auto& [request, argument] :
         {std::pair<unsigned long, void*>{SPI_IOC_WR_MODE, &mode_},
          {SPI_IOC_WR_BITS_PER_WORD, &bits_per_word_},
          {SPI_IOC_WR_MAX_SPEED_HZ, &speed_hz_}}) {
      if (const auto set = file_.ioctl(request, argument); !set) {
        file_.close();  // half configured is worse than closed: the next transaction begins anew
        return core::Unexpected{set.error()};
      }
    }
    return {};
  }

  core::Result<void, BusError> transfer(std::span<const Operation> operations) {
    std::array<spi_ioc_transfer, kMostOperations> transfers{};
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < operations.size(); ++i) {
      const Operation& operation = operations[i];
      // A null tx_buf sends zeros, a null rx_buf drops what comes
      // (include/uapi/linux/spi/spidev.h).
      transfers[i].tx_buf = address_of(operation.bytes().data());
      transfers[i].rx_buf = address_of(operation.buffer().data());
      transfers[i].len = static_cast<std::uint32_t>(operation.size());
      bytes += operation.size();
    }
    const auto done = file_.ioctl(message_request(operations.size()), transfers.data());
    if (!done) return core::Unexpected{done.error()};
    if (static_cast<std::size_t>(*done) != bytes) return core::Unexpected{BusError::io};
    return {};
  }

  [[nodiscard]] static std::uint64_t address_of(const std::uint8_t* bytes) {
    return reinterpret_cast<std::uintptr_t>(bytes);
  }

  /// SPI_IOC_MESSAGE(n) for an n known only at run time.
  [[nodiscard]] static unsigned long message_request(std::size_t operations) {
    return _IOC(_IOC_WRITE, SPI_IOC_MAGIC, 0, operations * sizeof(spi_ioc_transfer));
  }

  std::uint32_t speed_hz_;
  std::uint8_t mode_;
  std::uint8_t bits_per_word_ = 8;
  core::Duration pause_;
  core::Instant ended_at_;  ///< the newest transaction
  System system_;
  DeviceFile<System> file_;
};
static_assert(SpiDevice<SpidevDevice<>>);

}  // namespace zerorate::hal::linux_os

/// @file
/// An I2C bus, through the kernel's i2c-dev driver.
#pragma once

#include <linux/i2c-dev.h>
#include <linux/i2c.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "hal/contract/bus_error.hpp"
#include "hal/contract/bus_operation.hpp"
#include "hal/contract/i2c_bus.hpp"
#include "hal/linux/device_file.hpp"

namespace zerorate::hal::linux_os {

/// An I2cBus: one I2C_RDWR per transaction. Clock and retries are the adapter driver's, and the
/// limit of time where it does not take kTimeLimit. No heap after construction; one system call per
/// transaction.
template <class System = SystemCalls>
class I2cDevBus {
 public:
  static constexpr std::size_t kMostOperations = 8;
  /// Longest wait for a bus whose data line is stuck, in units of 10 ms; the kernel's is a second.
  /// It is the adapter's, and so holds for every program on the bus.
  static constexpr unsigned long kTimeLimit = 5;

  /// @param device e.g. "/dev/i2c-1"
  explicit I2cDevBus(std::string device, System system = {})
      : file_(std::move(device), Subsystem::i2c, std::move(system)) {}

  /// @param operations at most kMostOperations, each of at most 8192 bytes (the kernel's limit)
  core::Result<void, BusError> transaction(I2cAddress address,
                                           std::span<const Operation> operations) {
    ZERORATE_ASSERT(operations.size() <= kMostOperations);
    if (operations.empty()) return {};
    if (!file_.is_open() || address != reserved_) {
      if (const auto reserved = reserve(address); !reserved) return reserved;
    }
    std::array<i2c_msg, kMostOperations> messages{};
    for (std::size_t i = 0; i < operations.size(); ++i) {
      messages[i] = to_message(address, operations[i]);
    }
    i2c_rdwr_ioctl_data request{.msgs = messages.data(),
                                .nmsgs = static_cast<std::uint32_t>(operations.size())};
    const auto done = file_.ioctl(I2C_RDWR, &request);
    if (!done) return core::Unexpected{done.error()};
    // The answer is the number of messages that went through. Some adapters (i2c-virtio) report
    // that an address was not acknowledged by stopping short of it, without an error.
    if (static_cast<std::size_t>(*done) != operations.size())
      return core::Unexpected{BusError::nack};
    return {};
  }

  /// See DeviceFile.
  [[nodiscard]] int error_number() const { return file_.error_number(); }

 private:
  core::Result<void, BusError> reserve(I2cAddress address) {
    if (!file_.is_open()) {
      if (const auto opened = file_.open(); !opened) return opened;
      file_.set(I2C_TIMEOUT, kTimeLimit);
    }
    reserved_ = address;
    return file_.reserve(static_cast<off_t>(address));
  }

  [[nodiscard]] static i2c_msg to_message(I2cAddress address, const Operation& operation) {
    ZERORATE_ASSERT(!operation.is_exchange());
    // The kernel's structure has one pointer for both directions; what is written is not changed.
    std::uint8_t* const bytes = operation.is_read()
                                    ? operation.buffer().data()
                                    : const_cast<std::uint8_t*>(operation.bytes().data());
    return {.addr = static_cast<std::uint16_t>(address),
            .flags = static_cast<std::uint16_t>(operation.is_read() ? I2C_M_RD : 0),
            .len = static_cast<std::uint16_t>(operation.size()),
            .buf = bytes};
  }

  DeviceFile<System> file_;
  I2cAddress reserved_{};  ///< status of the newest transaction
};
static_assert(I2cBus<I2cDevBus<>>);

}  // namespace zerorate::hal::linux_os

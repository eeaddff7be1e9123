/// @file
/// The kernel's side of spidev and i2c-dev, with a simulated chip behind it, in place of the system
/// calls. Answers as the drivers do, and checks what they check.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <linux/spi/spidev.h>

#include <cerrno>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "hal/contract/bus_operation.hpp"
#include "hal/contract/i2c_bus.hpp"
#include "hal/linux/device_file.hpp"

namespace zerorate::hal::linux_os {

/// Requests to the kernel and the answers it shall give. Shared with the back end under test.
struct KernelState {
  static constexpr int kDescriptor = 33;

  std::function<void(std::span<const Operation>)> spi_device;
  std::function<bool(I2cAddress, std::span<const Operation>)> i2c_device;  ///< false: NACK

  std::optional<int> next_error;   ///< error of the next ioctl that transfers
  std::optional<int> next_answer;  ///< value that the next such ioctl returns as a success
  std::optional<int> open_error;   ///< error of every open, while set

  bool is_reserved = false;  ///< held by another program
  std::vector<off_t> locks;

  std::string opened_path;
  int opens = 0;
  int closes = 0;
  int transfers = 0;
  unsigned long i2c_timeout = 0;  ///< in 10 ms
  int spi_mode = -1;
  int spi_bits = -1;
  std::uint32_t spi_speed_hz = 0;
  core::Instant now;                  ///< moved by waiting alone
  std::vector<core::Duration> waits;  ///< those that were not over when they began
  std::vector<spi_ioc_transfer> last_spi;
  std::vector<i2c_msg> last_i2c;
};

class KernelDouble {
 public:
  explicit KernelDouble(KernelState& state) : state_(&state) {}

  CallResult open(const char* path, int flags) {
    EXPECT_EQ(flags & O_ACCMODE, O_RDWR);
    if (state_->open_error) return core::Unexpected{*state_->open_error};
    state_->opened_path = path;
    ++state_->opens;
    return KernelState::kDescriptor;
  }
  void close(int descriptor) {
    EXPECT_EQ(descriptor, KernelState::kDescriptor);
    ++state_->closes;
  }
  CallResult lock(int descriptor, off_t first, off_t count) {
    EXPECT_EQ(descriptor, KernelState::kDescriptor);
    EXPECT_EQ(count, 1);
    if (state_->is_reserved) return core::Unexpected{EAGAIN};
    state_->locks.push_back(first);
    return 0;
  }
  [[nodiscard]] core::Instant now() const { return state_->now; }
  void wait_until(core::Instant time) {
    if (time <= state_->now) return;
    state_->waits.push_back(time - state_->now);
    state_->now = time;
  }
  CallResult ioctl(int descriptor, unsigned long request, void* argument) {
    EXPECT_EQ(descriptor, KernelState::kDescriptor);
    switch (request) {
      case SPI_IOC_WR_MODE:
        state_->spi_mode = *static_cast<std::uint8_t*>(argument);
        return 0;
      case SPI_IOC_WR_BITS_PER_WORD:
        state_->spi_bits = *static_cast<std::uint8_t*>(argument);
        return 0;
      case SPI_IOC_WR_MAX_SPEED_HZ:
        state_->spi_speed_hz = *static_cast<std::uint32_t*>(argument);
        return 0;
      case I2C_TIMEOUT:
        state_->i2c_timeout = reinterpret_cast<unsigned long>(argument);
        return 0;
      case I2C_RDWR:
        return i2c(*static_cast<i2c_rdwr_ioctl_data*>(argument));
      default:
        return spi(request, static_cast<const spi_ioc_transfer*>(argument));
    }
  }

 private:
  std::optional<CallResult> scripted() {
    ++state_->transfers;
    if (state_->next_error) {
      const int error = *state_->next_error;
      state_->next_error.reset();
      return CallResult{core::Unexpected{error}};
    }
    if (state_->next_answer) {
      const int answer = *state_->next_answer;
      state_->next_answer.reset();
      return CallResult{answer};
    }
    return std::nullopt;
  }

  /// drivers/spi/spidev.c, spidev_ioctl and spidev_message.
  CallResult spi(unsigned long request, const spi_ioc_transfer* transfers) {
    EXPECT_EQ(_IOC_TYPE(request), unsigned{SPI_IOC_MAGIC});
    EXPECT_EQ(_IOC_NR(request), 0U);
    EXPECT_EQ(_IOC_SIZE(request) % sizeof(spi_ioc_transfer), 0U);
    state_->last_spi.assign(transfers, transfers + _IOC_SIZE(request) / sizeof(spi_ioc_transfer));
    if (const auto answer = scripted()) return *answer;
    std::vector<Operation> operations;
    int total = 0;
    for (const spi_ioc_transfer& transfer : state_->last_spi) {
      operations.push_back(to_operation(transfer));
      total += static_cast<int>(transfer.len);
    }
    if (state_->spi_device) state_->spi_device(operations);
    return total;
  }
  static Operation to_operation(const spi_ioc_transfer& transfer) {
    const std::span read{reinterpret_cast<std::uint8_t*>(transfer.rx_buf), transfer.len};
    const std::span written{reinterpret_cast<const std::uint8_t*>(transfer.tx_buf), transfer.len};
    if (transfer.tx_buf == 0) return Operation::read(read);
    if (transfer.rx_buf == 0) return Operation::write(written);
    return Operation::exchange(written, read);
  }

  /// drivers/i2c/i2c-dev.c, i2cdev_ioctl_rdwr: the number of messages that went through.
  CallResult i2c(const i2c_rdwr_ioctl_data& request) {
    state_->last_i2c.assign(request.msgs, request.msgs + request.nmsgs);
    if (const auto answer = scripted()) return *answer;
    std::vector<Operation> operations;
    for (const i2c_msg& message : state_->last_i2c) {
      EXPECT_EQ(message.addr, state_->last_i2c[0].addr);
      const std::span bytes{message.buf, message.len};
      operations.push_back((message.flags & I2C_M_RD) != 0 ? Operation::read(bytes)
                                                           : Operation::write(bytes));
    }
    const I2cAddress address{static_cast<std::uint8_t>(state_->last_i2c[0].addr)};
    if (state_->i2c_device && !state_->i2c_device(address, operations)) {
      return core::Unexpected{ENXIO};
    }
    return static_cast<int>(request.nmsgs);
  }

  KernelState* state_;
};

}  // namespace zerorate::hal::linux_os

/// @file
/// Devices of the emulated machine on a kernel without a module of ours.
#pragma once

#include <linux/fuse.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "host_tests/emulated/linux/guest/wires.hpp"

namespace zerorate::emulated {

/// One character device in user space (CUSE, Documentation/filesystems/fuse.rst and
/// include/uapi/linux/fuse.h) that answers the system calls of a bus. Pointers in the arguments of
/// an ioctl are followed by asking the kernel for what they point to, step by step.
class CuseBus {
 public:
  /// @param kind  ZERORATE_BUS_I2C or ZERORATE_BUS_SPI
  CuseBus(std::uint32_t kind, const char* name);

  [[nodiscard]] int descriptor() const { return cuse_; }
  /// Answers one request of the kernel, or makes a transaction of it.
  bool next(std::span<std::uint8_t> transaction);
  void answer(std::span<const std::uint8_t> answer);

 private:
  using Vectors = std::vector<fuse_ioctl_iovec>;
  /// Answer of an ioctl.
  struct Call {
    fuse_ioctl_in in;
    std::span<const std::uint8_t> data;
  };

  void name_device(const char* name);
  bool ioctl(const Call& call, std::span<std::uint8_t> transaction);
  bool spi(const Call& call, std::span<std::uint8_t> transaction);
  bool i2c(const Call& call, std::span<std::uint8_t> transaction);
  bool begin(std::span<const std::uint8_t> written, const zerorate_bus_transaction& head,
             std::span<std::uint8_t> transaction);
  void ask_for(const Vectors& in, const Vectors& out);
  void finish(int result, std::span<const std::uint8_t> data = {});
  void reply(int error, std::span<const std::uint8_t> first,
             std::span<const std::uint8_t> second = {});

  std::uint32_t kind_;
  int cuse_;
  std::uint64_t unique_ = 0;
  std::uint32_t mode_ = 0;
  std::vector<std::uint8_t> request_ = std::vector<std::uint8_t>(1U << 17U);
  zerorate_bus_transaction pending_{};
};

/// /dev/spidev0.0 and /dev/i2c-7 by CUSE. Lines are those of QEMU's own PL061: the other end of
/// /dev/ttyAMA0 drives them (stock_machine.py), and says so.
class StockWires final : public Wires {
 public:
  StockWires();
  bool next(std::span<std::uint8_t> transaction) override;
  void answer(std::span<const std::uint8_t> answer) override;
  void drive(int line, bool high) override;

 private:
  std::array<CuseBus, 2> buses_;
  CuseBus* asking_ = nullptr;
  std::mutex mutex_;  ///< the schedule and the bus both drive lines
  int console_;
  std::array<bool, 8> levels_{};
};

}  // namespace zerorate::emulated

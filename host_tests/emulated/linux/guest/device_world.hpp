/// @file
/// A simulated gyro and odometer behind the test modules' devices, inside the emulated machine.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/base/units.hpp"
#include "hal/linux/clock.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/spi.hpp"
#include "host_tests/emulated/linux/kernel/zerorate_bus.h"

namespace zerorate::emulated {

enum class BusFault { none, unplugged, no_answer, stuck_high };

[[noreturn]] inline void give_up(const char* what) {
  std::perror(what);
  std::exit(2);
}

inline int open_device(const char* path, int flags) {
  const int descriptor = open(path, flags);
  if (descriptor < 0) give_up(path);
  return descriptor;
}

/// Answers SPI transactions with an LSM6DSO, and drives its interrupt line and the odometer's.
class DeviceWorld {
 public:
  static constexpr int kDataReadyLine = 0;
  static constexpr int kOdometerLine = 1;

  DeviceWorld() : server_([this] { serve(); }) { server_.detach(); }

  void measure(const std::array<core::AngularRate, 3>& rate) {
    const std::lock_guard lock(mutex_);
    clock_.advance_to(hal::linux_os::KernelClock::now());
    chip_.measure(rate, core::Temperature::from_degc(25));
    show_data_ready();
  }
  /// One pulse; when its rising edge was given.
  core::Instant pulse() {
    const core::Instant at = hal::linux_os::KernelClock::now();
    drive(kOdometerLine, true);
    drive(kOdometerLine, false);
    return at;
  }
  void set_fault(BusFault fault) { fault_ = fault; }
  void set_data_ready_broken(bool is_broken) { is_data_ready_broken_ = is_broken; }
  [[nodiscard]] int spi_mode() const { return spi_mode_; }

 private:
  using Request = zerorate_bus_transaction;
  using Answer = zerorate_bus_answer;

  void drive(int line, bool high) const {
    const std::string text = std::to_string(line) + (high ? " 1" : " 0");
    if (write(lines_, text.data(), text.size()) < 0) give_up("zerorate_lines");
  }
  void show_data_ready() {
    if (!is_data_ready_broken_) drive(kDataReadyLine, chip_.interrupt().level());
  }

  void serve() {
    std::array<std::uint8_t, sizeof(Request) + ZERORATE_BUS_BYTES> in{};
    for (;;) {
      if (read(bus_, in.data(), in.size()) < 0) continue;  // it was too late for this one
      Request request{};
      std::memcpy(&request, in.data(), sizeof request);
      answer(request, std::span{in}.subspan(sizeof request));
    }
  }

  void answer(const Request& request, std::span<std::uint8_t> bytes) {
    const BusFault fault = fault_;
    if (fault == BusFault::no_answer) return;
    Answer head{.status = fault == BusFault::unplugged ? -ENODEV : 0};
    std::size_t size = 0;
    std::vector<hal::Operation> operations;
    for (std::uint32_t i = 0; i < request.segments; ++i) {
      const auto segment = bytes.subspan(size, request.segment[i].length);
      operations.push_back(operation(request.segment[i].direction, segment));
      size += segment.size();
    }
    if (fault == BusFault::stuck_high) {
      std::ranges::fill(bytes.first(size), std::uint8_t{0xFF});
    } else if (fault == BusFault::none) {
      const std::lock_guard lock(mutex_);
      clock_.advance_to(hal::linux_os::KernelClock::now());
      (void)device_.transaction(operations);
      show_data_ready();
    }
    spi_mode_ = static_cast<int>(request.mode);
    std::vector<std::uint8_t> out(sizeof head + size);
    std::memcpy(out.data(), &head, sizeof head);
    std::ranges::copy(bytes.first(size), out.begin() + sizeof head);
    (void)!write(bus_, out.data(), out.size());
  }

  static hal::Operation operation(std::uint32_t direction, std::span<std::uint8_t> bytes) {
    if (direction == ZERORATE_SEGMENT_READ) return hal::Operation::read(bytes);
    if (direction == ZERORATE_SEGMENT_WRITE) return hal::Operation::write(bytes);
    return hal::Operation::exchange(bytes, bytes);
  }

  int bus_ = open_device("/dev/zerorate_bus", O_RDWR);
  int lines_ = open_device("/dev/zerorate_lines", O_WRONLY);
  std::mutex mutex_;
  hal::sim::SimulatedClock clock_{hal::linux_os::KernelClock::now()};
  hal::sim::SimulatedLsm6dso chip_{clock_};
  hal::sim::SimulatedSpiDevice<hal::sim::SimulatedLsm6dso> device_{chip_};
  std::atomic<BusFault> fault_ = BusFault::none;
  std::atomic<bool> is_data_ready_broken_ = false;
  std::atomic<int> spi_mode_ = -1;
  std::thread server_;
};

}  // namespace zerorate::emulated

/// @file
/// The devices of the emulated machine: a gyro, its interrupt line and an odometer, with faults.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/units.hpp"
#include "hal/linux/clock.hpp"
#include "host_tests/emulated/linux/guest/played_chip.hpp"
#include "host_tests/emulated/linux/guest/wires.hpp"

namespace zerorate::emulated {

/// Faults that a bus makes in transactions.
enum class BusFault {
  none,
  unplugged,    ///< the controller says ENODEV
  no_answer,    ///< no answer within the controller's limit
  nack_bursts,  ///< three of a hundred transactions in a row are not acknowledged
  stuck_high,   ///< only ones come
  stuck_low,    ///< only zeros
  bit_errors,   ///< one bit of every hundredth answer is turned over
};

/// Answers the kernel's transactions with a chip, and drives its interrupt line and the odometer's.
class DeviceWorld {
 public:
  static constexpr int kDataReadyLine = 0;
  static constexpr int kOdometerLine = 1;

  DeviceWorld() : server_([this] { serve(); }) { server_.detach(); }

  /// Another chip in the place of the one before.
  void insert(std::unique_ptr<PlayedChip> chip) {
    const std::lock_guard lock(mutex_);
    chip_ = std::move(chip);
    transactions_ = 0;
    show_data_ready();
  }
  void measure(const std::array<core::AngularRate, 3>& rate) {
    const std::lock_guard lock(mutex_);
    chip_->measure(rate);
    show_data_ready();
  }
  /// One pulse; when its rising edge was given.
  core::Instant pulse() {
    const core::Instant at = hal::linux_os::KernelClock::now();
    wires_.drive(kOdometerLine, true);
    wires_.drive(kOdometerLine, false);
    return at;
  }
  [[nodiscard]] std::size_t reserved_writes() {
    const std::lock_guard lock(mutex_);
    return chip_->reserved_writes();
  }
  void set_fault(BusFault fault) { fault_ = fault; }
  void set_data_ready_broken(bool is_broken) { is_data_ready_broken_ = is_broken; }
  [[nodiscard]] int spi_mode() const { return spi_mode_; }
  /// Since the chip was inserted.
  [[nodiscard]] unsigned transactions() const { return transactions_; }

 private:
  using Request = zerorate_bus_transaction;
  using Answer = zerorate_bus_answer;
  static constexpr std::uint32_t kLast = ZERORATE_SEGMENT_LAST;

  void show_data_ready() {
    if (is_data_ready_broken_) return;
    if (chip_->take_edge()) {
      wires_.drive(kDataReadyLine, false);  // where the line rises, it was low
      wires_.drive(kDataReadyLine, true);
    }
    wires_.drive(kDataReadyLine, chip_->is_data_ready());
  }

  void serve() {
    std::array<std::uint8_t, sizeof(Request) + ZERORATE_BUS_BYTES> in{};
    for (;;) {
      if (!wires_.next(in)) continue;
      Request request{};
      std::memcpy(&request, in.data(), sizeof request);
      answer(request, std::span{in}.subspan(sizeof request));
    }
  }

  void answer(const Request& request, std::span<std::uint8_t> bytes) {
    spi_mode_ = static_cast<int>(request.mode);
    const unsigned number = ++transactions_;
    if (fault_ == BusFault::no_answer) return;
    std::size_t size = 0;
    std::vector<std::vector<hal::Operation>> transfers(1);
    for (std::uint32_t i = 0; i < request.segments; ++i) {
      const auto segment = bytes.subspan(size, request.segment[i].length);
      const std::uint32_t direction = request.segment[i].direction;
      transfers.back().push_back(operation(direction & ~kLast, segment));
      if ((direction & kLast) != 0 && i + 1 < request.segments) transfers.emplace_back();
      size += segment.size();
    }
    const Answer head{.status = carry_out(request, transfers, bytes.first(size), number)};
    std::vector<std::uint8_t> out(sizeof head + size);
    std::memcpy(out.data(), &head, sizeof head);
    std::ranges::copy(bytes.first(size), out.begin() + sizeof head);
    wires_.answer(out);
  }

  /// @return 0 or a negative error number
  int carry_out(const Request& request, std::span<const std::vector<hal::Operation>> transfers,
                std::span<std::uint8_t> bytes, unsigned number) {
    constexpr unsigned kFaultsEvery = 100;
    const BusFault fault = fault_;
    if (fault == BusFault::unplugged) return -ENODEV;
    if (fault == BusFault::nack_bursts && number % kFaultsEvery < 3) return -ENXIO;
    const std::lock_guard lock(mutex_);
    int status = 0;
    for (const auto& operations : transfers) {
      if (status == 0) status = chip_->transfer(request, operations);
    }
    show_data_ready();
    if (fault == BusFault::stuck_high) std::ranges::fill(bytes, std::uint8_t{0xFF});
    if (fault == BusFault::stuck_low) std::ranges::fill(bytes, std::uint8_t{0});
    if (fault == BusFault::bit_errors && number % kFaultsEvery == 0) {
      const unsigned bit = number / kFaultsEvery % (8U * static_cast<unsigned>(bytes.size()));
      bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << bit % 8));
    }
    return status;
  }

  static hal::Operation operation(std::uint32_t direction, std::span<std::uint8_t> bytes) {
    if (direction == ZERORATE_SEGMENT_READ) return hal::Operation::read(bytes);
    if (direction == ZERORATE_SEGMENT_WRITE) return hal::Operation::write(bytes);
    return hal::Operation::exchange(bytes, bytes);
  }

  Wires wires_;
  std::mutex mutex_;
  std::unique_ptr<PlayedChip> chip_ = on_spi<hal::sim::SimulatedLsm6dso>();
  std::atomic<BusFault> fault_ = BusFault::none;
  std::atomic<bool> is_data_ready_broken_ = false;
  std::atomic<int> spi_mode_ = -1;
  std::atomic<unsigned> transactions_ = 0;
  std::thread server_;
};

}  // namespace zerorate::emulated

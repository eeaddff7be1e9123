/// @file
/// A back end that fails on demand. For tests only, never in firmware.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/base/result.hpp"
#include "hal/contract/i2c_bus.hpp"
#include "hal/contract/spi_device.hpp"

namespace zerorate::hal::testing {

/// Faults of the transactions `first` to `first + calls - 1`, counted from 0.
struct Fault {
  enum class Kind : std::uint8_t {
    refused,       ///< the error is reported and nothing reaches the device
    after_effect,  ///< the device does all of it, and then the error is reported
    flipped_bit,   ///< success is reported, with one bit of what was read inverted
    stuck_high,    ///< success is reported, every byte read is 0xFF, nothing reaches the device
    stuck_low,     ///< like stuck_high, with 0x00
  };
  static constexpr std::size_t kForEver = std::numeric_limits<std::size_t>::max();

  Kind kind = Kind::refused;
  std::size_t first = 0;
  std::size_t calls = 1;
  BusError error = BusError::io;  ///< for refused and after_effect
  std::size_t bit = 0;  ///< for flipped_bit, of the first buffer: bit 0 to 7 of byte 0, then byte 1

  [[nodiscard]] bool hits(std::size_t call) const { return call >= first && call - first < calls; }
};

/// Faults that wait for their transactions, and the count of these.
class Faults {
 public:
  void inject(const Fault& fault) { faults_.push_back(fault); }
  /// Something that happens in front of a transaction: the chip measures.
  void before(std::size_t call, std::function<void()> event) {
    event_at_ = call;
    event_ = std::move(event);
  }
  void clear() { faults_.clear(); }
  /// How many transactions there were: the number of the next one.
  [[nodiscard]] std::size_t calls() const { return calls_; }

 protected:
  template <class Forward>
  core::Result<void, BusError> run(std::span<const Operation> operations, Forward forward) {
    const std::size_t call = calls_++;
    if (event_ && call == event_at_) event_();
    for (const Fault& fault : faults_) {
      if (fault.hits(call)) return fail(fault, operations, forward);
    }
    return forward();
  }

 private:
  template <class Forward>
  core::Result<void, BusError> fail(const Fault& fault, std::span<const Operation> operations,
                                    Forward forward) {
    using enum Fault::Kind;
    if (fault.kind == refused) return core::Unexpected{fault.error};
    if (fault.kind == stuck_high || fault.kind == stuck_low) {
      fill(operations, fault.kind == stuck_high ? 0xFF : 0x00);
      return {};
    }
    const auto done = forward();
    if (!done) return done;
    if (fault.kind == after_effect) return core::Unexpected{fault.error};
    flip(operations, fault.bit);
    return {};
  }

  static void fill(std::span<const Operation> operations, std::uint8_t value) {
    for (const Operation& operation : operations) {
      for (std::uint8_t& byte : operation.buffer()) byte = value;
    }
  }

  static void flip(std::span<const Operation> operations, std::size_t bit) {
    for (const Operation& operation : operations) {
      if (operation.buffer().size() <= bit / 8) continue;
      operation.buffer()[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      return;
    }
  }

  std::vector<Fault> faults_;
  std::size_t calls_ = 0;
  std::function<void()> event_;
  std::size_t event_at_ = 0;
};

/// Wraps any SpiDevice or I2cBus; without faults it changes nothing.
template <class BackEnd>
class FaultInjector : public Faults {
 public:
  explicit FaultInjector(BackEnd& back_end) : back_end_(&back_end) {}

  core::Result<void, BusError> transaction(
      std::span<const Operation> operations) requires SpiDevice<BackEnd> {
    return run(operations, [&] { return back_end_->transaction(operations); });
  }

  core::Result<void, BusError> transaction(
      I2cAddress address, std::span<const Operation> operations) requires I2cBus<BackEnd> {
    return run(operations, [&] { return back_end_->transaction(address, operations); });
  }

 private:
  BackEnd* back_end_;
};

}  // namespace zerorate::hal::testing

/// @file
/// I2C 0 (Synopsys DW_apb_i2c) as controller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "hal/contract/i2c_bus.hpp"
#include "hal/rp2040/chip.hpp"
#include "hal/rp2040/registers.hpp"
#include "hal/rp2040/timer.hpp"

namespace zerorate::hal::rp2040 {

/// An I2cBus at 400 kHz; the pull-ups of the pins help those on the board.
template <unsigned DataPin, unsigned ClockPin>
class I2c0Bus {
 public:
  static void start() {
    release_from_reset(resets::kI2c0);
    constexpr std::uint32_t kPeriod = kClockHz / 400'000;
    constexpr std::uint32_t kLow = kPeriod * 3 / 5;  // at least 1.3 of 2.5 us (I2C, fast mode)
    i2c0::kEnable.write(0);
    i2c0::kControl.write(i2c0::kControllerMode | i2c0::kFastMode | i2c0::kRestartEnabled |
                         i2c0::kTxEmptyWhenSent);
    i2c0::kFastLowCount.write(kLow);
    i2c0::kFastHighCount.write(kPeriod - kLow);
    i2c0::kSpikeLength.write(kLow / 16);                       // spikes below 50 ns are not seen
    i2c0::kDataHold.write(kClockHz / 1'000'000 * 3 / 10 + 1);  // 300 ns
    connect_lines(io_bank0::i2c);
  }

  /// Blocks for the transfer; timeout after 10 ms, which is 400 bytes. A data line that is held low
  /// is freed then, for the next transfer.
  static core::Result<void, BusError> transaction(I2cAddress address,
                                                  std::span<const Operation> operations) {
    std::size_t left = 0;
    for (const Operation& operation : operations) left += operation.size();
    if (left == 0) return {};
    select(address);
    const Deadline deadline{10'000};
    Framing framing;
    for (const Operation& operation : operations) {
      ZERORATE_ASSERT(!operation.is_exchange());
      left -= operation.size();
      framing.ends = left == 0;
      const bool is_done = operation.is_read() ? read(operation.buffer(), framing, deadline)
                                               : write(operation.bytes(), framing, deadline);
      if (!is_done) return failure();
      framing.begins_again = true;
    }
    while ((i2c0::kInterruptRaw.read() & i2c0::kStopDetected) == 0) {
      if (has_failed(deadline)) return failure();
    }
    // A byte that was not acknowledged ends with a STOP too.
    if ((i2c0::kInterruptRaw.read() & i2c0::kAborted) != 0) return failure();
    return {};
  }

 private:
  static constexpr std::size_t kFifoDepth = 16;

  static void connect_lines(io_bank0::Function function) {
    connect<DataPin>(function, Pull::up);
    connect<ClockPin>(function, Pull::up);
  }
  /// Half a clock of 100 kHz, slow enough for every chip.
  static void wait_half_clock() {
    const Deadline deadline{5};
    while (!deadline.is_over()) {
    }
  }
  template <unsigned Pin>
  static void drive_low() {
    sio::kOutEnableSet.write(bit(Pin));
    wait_half_clock();
  }
  /// The pull-up makes the line high.
  template <unsigned Pin>
  static void let_go() {
    sio::kOutEnableClear.write(bit(Pin));
    wait_half_clock();
  }

  /// A chip whose transfer was cut off while it sent a 0 holds the data line low for ever. Nine
  /// clocks bring it to a bit where it lets go (UM10204, 3.1.16), and a STOP ends the transfer.
  /// 0.2 ms. Not inlined: a board counts bytes.
  [[gnu::noinline]] static void free_data_line() {
    constexpr int kMostClocks = 9;
    i2c0::kEnable.write(0);
    sio::kOutEnableClear.write(bit(DataPin) | bit(ClockPin));
    sio::kOutClear.write(bit(DataPin) | bit(ClockPin));
    connect_lines(io_bank0::sio);
    for (int clocks = 0; clocks < kMostClocks && (sio::kIn.read() & bit(DataPin)) == 0; ++clocks) {
      drive_low<ClockPin>();
      let_go<ClockPin>();
    }
    drive_low<ClockPin>();
    drive_low<DataPin>();
    let_go<ClockPin>();
    let_go<DataPin>();
    connect_lines(io_bank0::i2c);
  }

  static void select(I2cAddress address) {
    i2c0::kEnable.write(0);  // empties the FIFOs, and allows the target to change
    i2c0::kTarget.write(static_cast<std::uint32_t>(address));
    i2c0::kEnable.write(1);
    i2c0::kClearAbort.touch();
    i2c0::kClearStop.touch();
  }

  /// START and STOP conditions around the bytes of one operation.
  struct Framing {
    bool begins_again = false;  ///< a repeated START before the first byte
    bool ends = false;          ///< a STOP after the last one

    [[nodiscard]] std::uint32_t of(std::size_t index, std::size_t size) const {
      return (begins_again && index == 0 ? i2c0::kRestart : 0U) |
             (ends && index + 1 == size ? i2c0::kStop : 0U);
    }
  };

  static bool write(std::span<const std::uint8_t> bytes, Framing framing,
                    const Deadline& deadline) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      while ((i2c0::kStatus.read() & i2c0::kTransmitNotFull) == 0) {
        if (has_failed(deadline)) return false;
      }
      i2c0::kDataCommand.write(bytes[i] | framing.of(i, bytes.size()));
    }
    return true;
  }

  /// Asks for as many bytes ahead as the receive FIFO holds.
  static bool read(std::span<std::uint8_t> buffer, Framing framing, const Deadline& deadline) {
    std::size_t asked = 0;
    std::size_t received = 0;
    while (received < buffer.size()) {
      if (asked < buffer.size() && asked - received < kFifoDepth &&
          (i2c0::kStatus.read() & i2c0::kTransmitNotFull) != 0) {
        i2c0::kDataCommand.write(i2c0::kRead | framing.of(asked, buffer.size()));
        ++asked;
      }
      if ((i2c0::kStatus.read() & i2c0::kReceiveNotEmpty) != 0) {
        buffer[received++] = static_cast<std::uint8_t>(i2c0::kDataCommand.read());
      } else if (has_failed(deadline)) {
        return false;
      }
    }
    return true;
  }

  static bool has_failed(const Deadline& deadline) {
    return (i2c0::kInterruptRaw.read() & i2c0::kAborted) != 0 || deadline.is_over();
  }

  [[gnu::noinline]] static core::Unexpected<BusError> failure() {
    const bool is_aborted = (i2c0::kInterruptRaw.read() & i2c0::kAborted) != 0;
    const bool is_lost = (i2c0::kAbortSource.read() & i2c0::kAbortLostArbitration) != 0;
    if (is_aborted && !is_lost) return core::Unexpected{BusError::nack};
    free_data_line();
    return core::Unexpected{is_aborted ? BusError::arbitration_lost : BusError::timeout};
  }
};
static_assert(I2cBus<I2c0Bus<4, 5>>);

}  // namespace zerorate::hal::rp2040

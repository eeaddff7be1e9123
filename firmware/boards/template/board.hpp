/// @file
/// Your board: seven holes to fill in, each between FILL IN and FILLED IN.
/// docs/how-to/port-to-a-board.md explains them; main.cpp needs no change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/result.hpp"
#include "drivers/chips/chips.hpp"
#include "drivers/common/register_access.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/boards/models/lsm6dso.hpp"
#include "hal/contract/spi_device.hpp"
#include "hal/contract/storage.hpp"
#include "hal/cortex_m/edges.hpp"
#include "hal/cortex_m/timer.hpp"

namespace zerorate::board {

/// Stands for your hardware: the compiler knows nothing of it. Delete it with the last hole.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
inline volatile std::uint32_t hardware;

/// 1, the clock: microseconds since some moment. It never jumps, lasts as long as the product
/// (widen a 32-bit counter in its interrupt), and may be read in interrupts.
struct Counter {
  // FILL IN
  static std::uint64_t microseconds() { return hardware; }
  // FILLED IN
};
using Clock = hal::cortex_m::CounterClock<Counter>;

/// 2, the bus: SPI or I2C (bytes on the wire: hal/contract). All operations under one chip
/// select; release it on every path; a time limit instead of waiting for ever. For I2C:
/// `transaction(address, operations)`, hal::I2cBus, and drivers::I2cRegisters below.
struct Bus {
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    // FILL IN
    hardware = 0;  // select the chip
    for (const hal::Operation& operation : operations) {
      for (std::size_t i = 0; i < operation.size(); ++i) {
        hardware = operation.is_read() ? 0U : operation.bytes()[i];
        const auto received = static_cast<std::uint8_t>(hardware);
        if (!operation.buffer().empty()) operation.buffer()[i] = received;
      }
    }
    hardware = 1;  // deselect it
    return {};
    // FILLED IN
  }
};
static_assert(hal::SpiDevice<Bus>);

/// 3, the gyro and its model: the chip (drivers/chips/chips.hpp), its settings, and the header that
/// `zerorate export --cpp` writes for its rate, in place of the Pico's above.
// FILL IN
using Chip = drivers::lsm6dso::Chip;
using Wire = drivers::SpiRegisters<Bus>;
inline constexpr Chip::Settings kSettings{};
// FILLED IN

/// 4, the capacity. A held tick costs 32 bytes: as many as fit into hold_back, and one. A predictor
/// that you do not publish need not run: the moving average costs 300 bytes an axis and 50 for each
/// of average_levels, the mean 40 an axis.
// FILL IN
inline constexpr app::NodeCapacity kCapacity{
    .held_ticks = 8, .runs_moving_average = false, .runs_calibration_mean = false};
// FILLED IN

/// 5, where messages go: all of the bytes into a queue, or none. Never wait.
struct Line {
  static bool send(std::span<const std::uint8_t> bytes) {
    // FILL IN
    for (const std::uint8_t byte : bytes) hardware = byte;
    return true;
    // FILLED IN
  }
};

/// 6, where one record stays while the power is off: two places, of which a save never touches the
/// newest. Backup RAM and NOR flash go through hal/cortex_m/flash_storage.hpp; an EEPROM or a file
/// system is a hal::Storage of your own. This one keeps nothing: the node learns anew after each
/// start.
struct Memory {
  // FILL IN
  static core::Result<std::size_t, hal::StorageError> load(std::span<std::uint8_t> /*record*/) {
    return core::Unexpected{hal::StorageError::empty};
  }
  static core::Result<void, hal::StorageError> save(std::span<const std::uint8_t> /*record*/) {
    return core::Unexpected{hal::StorageError::io};
  }
  // FILLED IN
};
static_assert(hal::Storage<Memory>);

/// 7, the start of the board, once and before anything else: clocks, pins, the interrupts that
/// stamp the edges below.
inline void start() {
  // FILL IN
  hardware = 0;
  // FILLED IN
}

/// Until the next interrupt: the tick of a timer, at least once a sample.
inline void sleep() {
  asm volatile("wfi");
}

/// Stamps of edges. Call on_edge(Clock::microseconds()) first thing in the interrupt of the
/// data-ready pin and of the odometer's; give both one priority. Without a data-ready line leave it
/// alone: the loop then looks by itself.
// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables)
inline constinit hal::cortex_m::LatestEdge<Counter> data_ready;
inline constinit hal::cortex_m::EdgeQueue<Counter, 32> pulses;
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

}  // namespace zerorate::board

/// @file
/// Simulated chips with 8-bit registers: what a bus needs of them, and what they have in common.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/data_ready_pin.hpp"

namespace zerorate::hal::sim {

/// - `read_register(address)` as the bus reads it, side effects included
/// - `write_register(address, value)` as the bus writes it
/// - `next_address(address)` where a burst goes on
template <class Chip>
concept RegisterChip = requires(Chip& chip, std::uint8_t byte) {
  { chip.read_register(byte) } -> std::same_as<std::uint8_t>;
  { chip.write_register(byte, byte) } -> std::same_as<void>;
  { chip.next_address(byte) } -> std::same_as<std::uint8_t>;
};

/// Registers of a chip, its clock, its reset and its interrupt pin.
template <std::size_t Count>
class SimulatedRegisters {
 public:
  [[nodiscard]] DataReadyPin& interrupt() { return interrupt_; }
  /// Writes to addresses that the data sheet reserves or does not list.
  [[nodiscard]] std::size_t reserved_writes() const { return reserved_writes_; }
  /// Flips bits of one register without a bus: an upset, as from radiation or a glitch.
  void upset(std::uint8_t address, std::uint8_t flipped_bits) {
    registers_.at(address) ^= flipped_bits;
  }

 protected:
  /// @param clock the simulation's time; must outlive the chip
  explicit SimulatedRegisters(const SimulatedClock& clock)
      : clock_(&clock), reset_until_(clock.now()) {}

  [[nodiscard]] bool is_resetting() const { return clock_->now() < reset_until_; }

  const SimulatedClock* clock_;
  std::array<std::uint8_t, Count> registers_{};
  core::Instant reset_until_;
  std::size_t reserved_writes_ = 0;
  DataReadyPin interrupt_;
};

}  // namespace zerorate::hal::sim

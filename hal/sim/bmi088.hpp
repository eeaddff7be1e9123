/// @file
/// The gyro of a BMI088 at the level of its registers, fed with physical values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/data_ready_pin.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// The gyro die (Bosch BST-BMI088-DS001, 5.4 and 5.5): identity, reset values, software reset,
/// power-up transient, rounding and clipping, data-ready flag that falls by itself, FIFO with
/// watermark and overrun, INT3.
///
/// Not modelled: the accelerometer die and its thermometer, filters, the self-test, the locking of
/// a rate's high byte, tags, INT4, bypass with depth one.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedBmi088 {
 public:
  static constexpr std::string_view kName = "bmi088";

  /// @param clock the simulation's time; must outlive the chip
  explicit SimulatedBmi088(const SimulatedClock& clock)
      : clock_(&clock), reset_until_(clock.now()) {
    reset_registers();
  }

  /// One conversion: rounds to the LSB, clips, raises data-ready, fills the FIFO. Does nothing
  /// while the gyro is suspended or in reset.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  [[nodiscard]] bool is_powered() const;
  /// Nominal period of the configured rate; zero when suspended.
  [[nodiscard]] core::Duration sample_period() const;
  [[nodiscard]] DataReadyPin& interrupt() { return int3_; }
  /// Writes to addresses that the datasheet does not list.
  [[nodiscard]] std::size_t reserved_writes() const { return reserved_writes_; }

  /// Interrupted supply: everything is as after power-on.
  void cycle_power() {
    reset_registers();
    reset_until_ = clock_->now();
  }
  /// An upset, as from radiation or a glitch: flips bits of one register without a bus.
  void upset(std::uint8_t address, std::uint8_t flipped_bits) {
    registers_.at(address) ^= flipped_bits;
  }

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 private:
  using Frame = std::array<std::uint8_t, 6>;

  void reset_registers();
  void clear_fifo();
  [[nodiscard]] bool is_resetting() const { return clock_->now() < reset_until_; }
  void push_frame();
  std::uint8_t read_fifo_byte();
  void drive_int3(bool is_new_sample);

  const SimulatedClock* clock_;
  std::array<std::uint8_t, 64> registers_{};
  std::deque<Frame> fifo_;
  std::size_t fifo_cursor_ = 0;  ///< bytes of the oldest frame that were read
  bool is_overrun_ = false;
  core::Instant reset_until_;  ///< from then on the gyro runs
  core::Instant measured_at_;
  std::size_t reserved_writes_ = 0;
  DataReadyPin int3_;
};
static_assert(RegisterChip<SimulatedBmi088>);

}  // namespace zerorate::hal::sim

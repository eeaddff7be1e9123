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
class SimulatedBmi088 : public SimulatedRegisters<64> {
 public:
  static constexpr std::string_view kName = "bmi088";

  /// @param clock the simulation's time; must outlive the chip
  explicit SimulatedBmi088(const SimulatedClock& clock) : SimulatedRegisters(clock) {
    reset_registers();
  }

  /// One conversion: rounds to the LSB, clips, raises data-ready, fills the FIFO. Does nothing
  /// while the gyro is suspended or in reset.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  [[nodiscard]] bool is_powered() const;
  /// Nominal period of the configured rate; zero when suspended.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power() {
    reset_registers();
    reset_until_ = clock_->now();
  }

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 private:
  using Frame = std::array<std::uint8_t, 6>;

  void reset_registers();
  void clear_fifo();
  void push_frame();
  std::uint8_t read_fifo_byte();
  void drive_int3(bool is_new_sample);

  std::deque<Frame> fifo_;
  std::size_t fifo_cursor_ = 0;  ///< bytes of the oldest frame that were read
  bool is_overrun_ = false;
  core::Instant measured_at_;
};
static_assert(RegisterChip<SimulatedBmi088>);

}  // namespace zerorate::hal::sim

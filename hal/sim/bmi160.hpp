/// @file
/// A BMI160 at the level of its registers, fed with physical values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/accelerometer.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// The chip (Bosch BST-BMI160-DS000): identity, reset values, commands (reset, power of both
/// sensors, flush), start-up transients, rounding and clipping, data-ready, FIFO of frames without
/// headers that drops the oldest, watermark, temperature, INT1 not latched: a pulse for each
/// sample. An acceleration cannot be lost: each frame has both sensors.
///
/// Not modelled: the switch from I2C to SPI, headers and sensor time of the FIFO, different rates
/// of the sensors, filters, low-power modes, offsets, self-test, motion interrupts, magnetometer,
/// INT2.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedBmi160 : public SimulatedRegisters<128>, public SimulatedAccelerometer {
 public:
  static constexpr std::string_view kName = "bmi160";

  /// @param clock the simulation's time; must outlive the chip
  explicit SimulatedBmi160(const SimulatedClock& clock) : SimulatedRegisters(clock) {
    reset_registers();
  }

  /// One conversion: rounds to the LSB, clips, raises data-ready, fills the FIFO. Does nothing
  /// while the gyro is suspended or starts.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  [[nodiscard]] bool is_powered() const;
  [[nodiscard]] bool is_accelerometer_powered() const;
  /// Nominal period of the configured rate; zero when suspended.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power() { reset_registers(); }

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 private:
  void reset_registers();
  void set_words(std::uint8_t address, const std::array<std::int16_t, 3>& values);
  void push_frame();
  [[nodiscard]] std::size_t frame_bytes() const;
  std::uint8_t read_fifo_byte();
  void run(std::uint8_t command);
  void drive_int1(bool is_new_sample);

  std::deque<std::uint8_t> fifo_;
  bool is_gyro_on_ = false;
  bool is_accelerometer_on_ = false;
  core::Instant gyro_at_;           ///< end of its start
  core::Instant accelerometer_at_;  ///< end of its start
};
static_assert(RegisterChip<SimulatedBmi160>);

}  // namespace zerorate::hal::sim

/// @file
/// An ICM-20948 at the level of its registers, fed with physical values.
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

/// The chip (InvenSense DS-000189): identity, banks 0 and 2 with their reset values, reset, sleep,
/// standby of single axes, start-up transients, rounding and clipping of both sensors, offset
/// registers of the gyro, data-ready, FIFO of bytes without tags with overflow in both modes and
/// its reset, temperature, INT1 pulsed or latched, high or low. An acceleration cannot be lost:
/// each sample has both sensors.
///
/// Banks 1 and 3 are empty: they read as 0, and writing to them counts as a reserved
/// write. Not modelled: filters, different rates of the sensors, self-test, wake on motion, FSYNC,
/// the I2C master and the magnetometer behind it, DMP, low-power cycles, and with them the bits of
/// INT_STATUS, which alone any reading may clear; writing into the FIFO.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock. Addresses for upset() have bit 7 for bank 2.
class SimulatedIcm20948 : public SimulatedRegisters<256>, public SimulatedAccelerometer {
 public:
  static constexpr std::string_view kName = "icm20948";

  /// @param clock the simulation's time; must outlive the chip
  explicit SimulatedIcm20948(const SimulatedClock& clock) : SimulatedRegisters(clock) {
    reset_registers();
  }

  /// One conversion: rounds to the LSB, clips, raises data-ready, fills the FIFO. Does nothing
  /// while the chip sleeps or is in reset.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  /// True if some axis of the gyro is on.
  [[nodiscard]] bool is_powered() const;
  /// True if some axis of the accelerometer is on.
  [[nodiscard]] bool is_accelerometer_powered() const;
  /// Nominal period of the configured rate; zero when asleep.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power() { reset_registers(); }

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 private:
  [[nodiscard]] bool is_awake() const;
  [[nodiscard]] unsigned bank() const;
  void reset_registers();
  void write_bank_0(std::uint8_t address, std::uint8_t value);
  void set_word(std::size_t address, std::int16_t value);
  [[nodiscard]] double offset_dps(std::size_t axis) const;
  void measure_rates(const std::array<core::AngularRate, 3>& rate);
  void measure_acceleration();
  void push_sample();
  void push_registers(std::size_t first, std::size_t count);
  std::uint8_t read_fifo_byte();
  std::uint8_t take_status(std::uint8_t address);
  void drive_int(bool is_active);
  void announce(bool is_enabled);

  std::deque<std::uint8_t> fifo_;
  core::Instant powered_at_;
  core::Instant accelerometer_powered_at_;
};
static_assert(RegisterChip<SimulatedIcm20948>);

}  // namespace zerorate::hal::sim

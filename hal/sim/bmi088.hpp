/// @file
/// The two dies of a BMI088 at the level of their registers, fed with physical values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/accelerometer.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

class SimulatedBmi088Module;
struct SimulatedBmi088Spi;

/// The gyro die (Bosch BST-BMI088-DS001, 5.4 and 5.5): identity, reset values, software reset,
/// power-up transient, rounding and clipping, data-ready flag that falls by itself, FIFO with
/// watermark and overrun, INT3.
///
/// Not modelled: filters, the self-test, the locking of
/// a rate's high byte, tags, INT4, bypass with depth one.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedBmi088 : public SimulatedRegisters<64> {
 public:
  static constexpr std::string_view kName = "bmi088";
  using Module = SimulatedBmi088Module;  ///< with the accelerometer

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

/// The accelerometer die (DS001, 5.2 and 5.3): identity, reset values, software reset, suspend,
/// power-up transient, rounding and clipping, FIFO of frames with a header, which drops its oldest.
///
/// Not modelled: a clock of its own (it converts with the gyro) and its rate, thermometer, sensor
/// time, other frames than those of acceleration, watermark, interrupts, self-test, the switch from
/// I2C to SPI, the times between steps of the power-up.
class SimulatedBmi088Accelerometer : public SimulatedRegisters<128>, public SimulatedAccelerometer {
 public:
  explicit SimulatedBmi088Accelerometer(const SimulatedClock& clock) : SimulatedRegisters(clock) {
    reset_registers();
  }

  /// One conversion. Does nothing while the die is suspended, off or in reset.
  void measure_force();
  [[nodiscard]] bool is_powered() const;
  void cycle_power() { reset_registers(); }

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 private:
  using Frame = std::array<std::uint8_t, 7>;

  void reset_registers();
  [[nodiscard]] std::uint8_t length_byte(std::size_t byte) const;

  std::deque<Frame> fifo_;
  std::size_t fifo_cursor_ = 0;  ///< bytes of the oldest frame that were read
  core::Instant powered_at_;
};
static_assert(RegisterChip<SimulatedBmi088Accelerometer>);

/// Both dies of one module.
class SimulatedBmi088Module : public SimulatedBmi088 {
 public:
  using Spi = SimulatedBmi088Spi;  ///< both dies on SPI

  explicit SimulatedBmi088Module(const SimulatedClock& clock)
      : SimulatedBmi088(clock), accelerometer_(clock) {}

  [[nodiscard]] SimulatedBmi088Accelerometer& accelerometer() { return accelerometer_; }
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature) {
    SimulatedBmi088::measure(rate, temperature);
    accelerometer_.measure_force();
  }
  void set_specific_force(const SimulatedAccelerometer::Force& force,
                          core::Acceleration noise = {}) {
    accelerometer_.set_specific_force(force, noise);
  }
  void lose_accelerations(int conversions) { accelerometer_.lose_accelerations(conversions); }
  /// Upset of the die whose registers are there: the gyro's end at 3Fh.
  void upset(std::uint8_t address, std::uint8_t flipped_bits) {
    if (address < 0x40) return SimulatedBmi088::upset(address, flipped_bits);
    accelerometer_.upset(address, flipped_bits);
  }
  void cycle_power() {
    SimulatedBmi088::cycle_power();
    accelerometer_.cycle_power();
  }
  [[nodiscard]] std::size_t reserved_writes() const {
    return SimulatedBmi088::reserved_writes() + accelerometer_.reserved_writes();
  }

 private:
  SimulatedBmi088Accelerometer accelerometer_;
};

/// An I2cBus with both dies.
class SimulatedBmi088I2c {
 public:
  SimulatedBmi088I2c(SimulatedBmi088Module& module, I2cAddress gyro, I2cAddress accelerometer)
      : gyro_(module, gyro),
        accelerometer_(module.accelerometer(), accelerometer),
        accelerometer_address_(accelerometer) {}

  core::Result<void, BusError> transaction(I2cAddress address,
                                           std::span<const Operation> operations) {
    return address == accelerometer_address_ ? accelerometer_.transaction(address, operations)
                                             : gyro_.transaction(address, operations);
  }

 private:
  SimulatedI2cBus<SimulatedBmi088> gyro_;
  SimulatedI2cBus<SimulatedBmi088Accelerometer> accelerometer_;
  I2cAddress accelerometer_address_;
};

/// An SpiDevice for each die. The accelerometer sends a dummy byte first (DS001, 6.1.2).
struct SimulatedBmi088Spi {
  explicit SimulatedBmi088Spi(SimulatedBmi088Module& module)
      : gyro(module), accelerometer(module.accelerometer()) {}

  SimulatedSpiDevice<SimulatedBmi088> gyro;
  SimulatedSpiDevice<SimulatedBmi088Accelerometer, 1> accelerometer;
};

}  // namespace zerorate::hal::sim

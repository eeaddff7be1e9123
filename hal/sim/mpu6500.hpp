/// @file
/// An MPU-6500 or a relative at the level of its registers, fed with physical values.
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
#include "hal/sim/clock.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// The chip (InvenSense RM-MPU-6500A-00, RM-MPU-6000A-00): identity, reset values, reset of the
/// device and of the signal paths, sleep, standby of single axes, start-up transients, rounding and
/// clipping of both sensors, offset registers of the gyro, sample rate divider, data-ready, FIFO of
/// bytes without tags with overflow in both modes, temperature, INT pulsed or latched, high or low.
/// An acceleration cannot be lost: each sample has both sensors.
///
/// Not modelled: offset registers of the accelerometer, filters, self-test, wake on motion, FSYNC,
/// the I2C master (its registers are memory, but see SimulatedMpu9250), DMP, low-power cycles.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedMpu6500 : public SimulatedRegisters<128>, public SimulatedAccelerometer {
 public:
  static constexpr std::string_view kName = "mpu6500";
  static constexpr std::uint8_t kIdentityMpu6050 = 0x68;
  static constexpr std::uint8_t kIdentityMpu6500 = 0x70;
  static constexpr std::uint8_t kIdentityMpu9250 = 0x71;
  static constexpr std::uint8_t kIdentityIcm20689 = 0x98;
  static constexpr std::uint8_t kIdentityIcm20602 = 0x12;
  static constexpr std::uint8_t kIdentityMpu6886 = 0x19;

  /// @param clock the simulation's time; must outlive the chip
  /// @param identity of WHO_AM_I. Those of the MPU-6050, the ICM-20689, the ICM-20602 and the
  /// MPU-6886 bring FIFO, thermometer, reset values and reserved registers; with any other the chip
  /// is an MPU-6500 that identifies as one.
  explicit SimulatedMpu6500(const SimulatedClock& clock, std::uint8_t identity = kIdentityMpu6500)
      : SimulatedRegisters(clock), identity_(identity) {
    reset_registers();
  }

  /// One conversion: rounds to the LSB, clips, raises data-ready, fills the FIFO. Does nothing
  /// while the chip sleeps or is in reset; without the gyro it measures the temperature alone.
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
  [[nodiscard]] bool is_mpu6050() const { return identity_ == kIdentityMpu6050; }
  [[nodiscard]] bool is_icm20689() const { return identity_ == kIdentityIcm20689; }
  /// ICM-20602 or MPU-6886.
  [[nodiscard]] bool is_icm20602() const {
    return identity_ == kIdentityIcm20602 || identity_ == kIdentityMpu6886;
  }
  [[nodiscard]] bool is_reserved(std::uint8_t address) const;
  [[nodiscard]] std::size_t fifo_capacity() const;
  [[nodiscard]] double temperature_counts(double degc) const;
  [[nodiscard]] bool is_awake() const;
  [[nodiscard]] double offset_dps(std::size_t axis) const;
  void reset_registers();
  void set_word(std::uint8_t address, std::int16_t value);
  void measure_acceleration();
  void push_sample();
  void push_bytes(std::span<const std::uint8_t> bytes);
  std::uint8_t read_fifo_byte();
  std::uint8_t take_status();
  void reset_parts(std::uint8_t address, std::uint8_t value);
  void drive_int(bool is_active);
  void announce(unsigned events);

  std::uint8_t identity_;
  std::deque<std::uint8_t> fifo_;
  std::uint8_t last_fifo_byte_ = 0;   ///< answer of an empty FIFO
  std::uint8_t latched_count_l_ = 0;  ///< FIFO_COUNTL as of the newest reading of FIFO_COUNTH
  core::Instant powered_at_;
  core::Instant accelerometer_powered_at_;
};
static_assert(RegisterChip<SimulatedMpu6500>);

/// The MPU-6050, which has I2C alone.
class SimulatedMpu6050 : public SimulatedMpu6500 {
 public:
  explicit SimulatedMpu6050(const SimulatedClock& clock)
      : SimulatedMpu6500(clock, kIdentityMpu6050) {}
};

/// The MPU-9250, and of its magnetometer, an AK8963 behind the I2C master, its identity and the
/// factors in its fuses, here all 1. Of the master's slaves the first alone is modelled: it is
/// served once, when the master is switched on.
class SimulatedMpu9250 : public SimulatedMpu6500 {
 public:
  explicit SimulatedMpu9250(const SimulatedClock& clock)
      : SimulatedMpu6500(clock, kIdentityMpu9250) {}

  void write_register(std::uint8_t address, std::uint8_t value);

 private:
  void serve_first_slave();
};
static_assert(RegisterChip<SimulatedMpu9250>);

/// Its FIFO of up to 4096 bytes has the 512 of the reset.
class SimulatedIcm20689 : public SimulatedMpu6500 {
 public:
  static constexpr std::string_view kName = "icm20689";
  explicit SimulatedIcm20689(const SimulatedClock& clock)
      : SimulatedMpu6500(clock, kIdentityIcm20689) {}
};

/// The gyro goes into its FIFO with the temperature alone.
class SimulatedIcm20602 : public SimulatedMpu6500 {
 public:
  static constexpr std::string_view kName = "icm20602";
  explicit SimulatedIcm20602(const SimulatedClock& clock)
      : SimulatedMpu6500(clock, kIdentityIcm20602) {}
};

/// An ICM-20602 by another name.
class SimulatedMpu6886 : public SimulatedMpu6500 {
 public:
  static constexpr std::string_view kName = "mpu6886";
  explicit SimulatedMpu6886(const SimulatedClock& clock)
      : SimulatedMpu6500(clock, kIdentityMpu6886) {}
};

}  // namespace zerorate::hal::sim

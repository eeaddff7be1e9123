/// @file
/// A BMI270 at the level of its registers, fed with physical values.
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

/// The chip (Bosch BST-BMI270-DS000): identity, reset values, power save, loading of its file,
/// power of both sensors and of the thermometer, start-up transients, rounding and clipping,
/// data-ready, FIFO of frames without headers that drops the oldest or stops, watermark,
/// temperature, INT1 not latched. An acceleration cannot be lost: each frame has both sensors.
///
/// Bosch's file is not here. The chip takes any file whose bytes add up to A5h (modulo 256) and
/// that was loaded without a gap, such as config_file(); any other it reports as damaged.
///
/// Not modelled: the switch from I2C to SPI, headers and sensor time of the FIFO, different rates
/// for gyro and accelerometer, filters, low-power modes, offsets, self-test, magnetometer, second
/// interface, INT2. Of the features that the file brings only GYR_CAS is modelled.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedBmi270 : public SimulatedRegisters<128>, public SimulatedAccelerometer {
 public:
  static constexpr std::string_view kName = "bmi270";
  static constexpr std::size_t kSpiDummies = 1;

  /// @param clock the simulation's time; must outlive the chip
  explicit SimulatedBmi270(const SimulatedClock& clock) : SimulatedRegisters(clock) {
    reset_registers();
  }

  /// File that the chip takes, of 600 bytes.
  [[nodiscard]] static std::span<const std::uint8_t> config_file();
  /// Bytes that were loaded into the chip since its reset, up to the first gap.
  [[nodiscard]] std::span<const std::uint8_t> loaded() const;

  /// Adds a share of the rate about z to the output of x, and stores it in GYR_CAS.
  /// @param counts  share in 1/512, -64 to 63
  void set_cross_sensitivity(int counts) { cross_counts_ = counts; }

  /// One conversion: rounds to the LSB, clips, raises data-ready, fills the FIFO. Does nothing
  /// while the gyro is off.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  [[nodiscard]] bool is_powered() const;
  [[nodiscard]] bool is_accelerometer_powered() const;
  /// Nominal period of the configured rate; zero when off.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power() { reset_registers(); }

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 private:
  static constexpr std::size_t kImageBytes = 8192;

  void reset_registers();
  void set_words(std::uint8_t address, const std::array<std::int16_t, 3>& values);
  void push_frame();
  [[nodiscard]] std::size_t frame_bytes() const;
  std::uint8_t read_fifo_byte();
  void load(std::uint8_t value);
  void run(std::uint8_t command);
  void react(std::uint8_t address, std::uint8_t risen);
  void finish_loading();
  [[nodiscard]] std::uint8_t internal_status() const;
  [[nodiscard]] bool is_initialised() const { return internal_status() == 0x01; }
  void drive_int1();

  std::array<std::uint8_t, kImageBytes> image_{};
  std::array<bool, kImageBytes> is_loaded_{};
  int cross_counts_ = 0;
  std::size_t place_ = 0;  ///< index of the next byte of the file
  bool is_file_good_ = false;
  core::Instant judged_at_;  ///< when the file was judged, or will be
  std::deque<std::uint8_t> fifo_;
  core::Instant gyro_on_at_;
  core::Instant accelerometer_on_at_;
};
static_assert(RegisterChip<SimulatedBmi270>);

}  // namespace zerorate::hal::sim

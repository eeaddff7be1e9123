/// @file
/// An ICM-42688-P at the level of its registers, fed with physical values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/accelerometer.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/packet_fifo.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// The chip (TDK DS-000347) as a gyro that has an accelerometer beside it: identity, reset values,
/// software reset, register banks, power-up transients, rounding and clipping, data-ready, FIFO of
/// packets of the gyro or of both, with watermark and full flag, temperature, INT1 in pulsed mode.
///
/// Not modelled: the accelerometer without the gyro or at another rate (it converts with the gyro),
/// packets of the accelerometer alone, filters, 20-bit packets, time stamps, FSYNC, latched
/// interrupts, INT2, little-endian data, the content of banks 1 to 4 (they read as 0), APEX.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedIcm42688 : public SimulatedRegisters<128>, public SimulatedAccelerometer {
 public:
  static constexpr std::string_view kName = "icm42688";
  static constexpr std::uint8_t kIdentityIcm42605 = 0x42;
  static constexpr std::uint8_t kIdentityIcm42688 = 0x47;
  static constexpr std::uint8_t kIdentityIim42652 = 0x6F;

  /// @param clock the simulation's time; must outlive the chip
  /// @param identity of WHO_AM_I
  explicit SimulatedIcm42688(const SimulatedClock& clock, std::uint8_t identity = kIdentityIcm42688)
      : SimulatedRegisters(clock), identity_(identity) {
    reset_registers();
  }

  /// One conversion: rounds to the LSB, clips, raises data-ready, fills the FIFO. Does nothing
  /// while the gyro is powered down or in reset.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  [[nodiscard]] bool is_powered() const;
  [[nodiscard]] bool is_accelerometer_powered() const;
  /// Nominal period of the configured rate; zero when powered down.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power() { reset_registers(); }

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 private:
  static constexpr std::size_t kFifoBytes = 2048;

  void reset_registers();
  void set_word(std::uint8_t address, std::int16_t value);
  void measure_acceleration();
  void note_power(std::uint8_t address);
  void push_packet(core::Temperature temperature);
  [[nodiscard]] std::size_t watermark_bytes() const;
  void pulse_int1();

  std::uint8_t identity_;
  PacketFifo fifo_;
  bool is_flushed_ = false;  ///< and its level was not read since, which will read as 0
  core::Instant powered_at_;
  core::Instant accelerometer_powered_at_;
};
static_assert(RegisterChip<SimulatedIcm42688>);

/// The older sister, whose gyro has the same registers.
class SimulatedIcm42605 : public SimulatedIcm42688 {
 public:
  static constexpr std::string_view kName = "icm42605";
  explicit SimulatedIcm42605(const SimulatedClock& clock)
      : SimulatedIcm42688(clock, kIdentityIcm42605) {}
};

/// The sister for industry, with the same registers.
class SimulatedIim42652 : public SimulatedIcm42688 {
 public:
  static constexpr std::string_view kName = "iim42652";
  explicit SimulatedIim42652(const SimulatedClock& clock)
      : SimulatedIcm42688(clock, kIdentityIim42652) {}
};

}  // namespace zerorate::hal::sim

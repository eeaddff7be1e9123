/// @file
/// An ICM-45686 at the level of its registers, fed with physical values.
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

/// The chip (TDK) as a gyro that has an accelerometer beside it: identity, reset values, software
/// reset, the window to the indirect registers with its time, byte order, power-up transients,
/// rounding and clipping, data-ready, FIFO of packets of the gyro or of both in stream and
/// stop-on-full mode, with depth, flush, watermark, full flag and a count that is one reading old,
/// temperature, INT1 in pulsed mode. A status bit shows only where its interrupt is enabled. What
/// the data sheet's rules of order forbid counts as a write to a reserved register.
///
/// Not modelled: the accelerometer without the gyro or at another rate (it converts with the gyro),
/// packets of the accelerometer alone, filters, 20-bit and compressed packets, time stamps, FSYNC,
/// latched interrupts, INT2, the second interface, eDMP, I3C.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedIcm45686 : public SimulatedRegisters<256>, public SimulatedAccelerometer {
 public:
  static constexpr std::string_view kName = "icm45686";

  /// @param clock the simulation's time; must outlive the chip
  explicit SimulatedIcm45686(const SimulatedClock& clock) : SimulatedRegisters(clock) {
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
  void reset_registers();
  void set_word(std::size_t address, std::int16_t value);
  void measure_acceleration();
  void push_packet(core::Temperature temperature);
  void raise_status(unsigned bits);
  [[nodiscard]] std::size_t fifo_bytes() const;
  [[nodiscard]] std::size_t watermark() const;
  [[nodiscard]] bool is_flushing() const { return clock_->now() < flushed_at_; }
  std::uint8_t read_count_low();
  std::uint8_t read_window();
  void write_window(std::uint8_t value);
  void store(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] bool is_against_the_order(std::uint8_t address, std::uint8_t value) const;
  void note_power(std::uint8_t address);
  void pulse_int1();

  PacketFifo fifo_;
  std::size_t count_ = 0;  ///< packets of the next reading
  std::size_t shown_ = 0;  ///< packets of the last reading
  bool is_window_busy_ = false;
  core::Instant flushed_at_;
  core::Instant powered_at_;
  core::Instant accelerometer_powered_at_;
};
static_assert(RegisterChip<SimulatedIcm45686>);

}  // namespace zerorate::hal::sim

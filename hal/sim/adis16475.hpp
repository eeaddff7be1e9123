/// @file
/// An ADIS16470 or ADIS16475 at the level of its words, fed with physical values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/accelerometer.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// The chip (Analog Devices, ADIS16470 rev. C and ADIS16475 rev. D): replies one word late, writes
/// byte by byte, burst with checksum, data counter, status that a read clears, reset and start-up
/// during which it is silent, start-up transient, rounding and clipping at 16 bits, temperature,
/// data-ready that is active while the outputs are valid.
///
/// Not modelled: the average of DEC_RATE and the filter, as each conversion is one output; the low
/// words, angle and velocity increments, synchronisation, bias estimation, self-test and flash.
/// Commands other than the reset do nothing.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedAdis16475 : public SimulatedRegisters<128>, public SimulatedAccelerometer {
 public:
  /// Figures that differ between the parts.
  struct Part {
    std::uint16_t product;
    std::uint8_t model;  ///< low byte of RANG_MDL
    double counts_per_dps;
    double counts_per_g;
  };

  /// @param clock the simulation's time; must outlive the chip
  SimulatedAdis16475(const SimulatedClock& clock, const Part& part)
      : SimulatedRegisters(clock), part_(part) {
    reset_registers();
  }

  /// One conversion: rounds to the LSB, clips, counts, signals. Does nothing while the chip starts.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  [[nodiscard]] bool is_powered() const { return !is_resetting(); }
  /// Period of the configured rate.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power();
  /// Sets faults in the status, which the next read of it clears.
  void fail(std::uint16_t faults) { status_ |= faults; }

  // The bus's side (WordChip).
  void select() { burst_at_ = kNoBurst; }
  [[nodiscard]] std::uint16_t reply();
  void take(std::uint16_t word);
  void refuse_clocks();

 private:
  static constexpr std::size_t kNoBurst = 0xFF;
  static constexpr std::size_t kBurstWords = 10;

  void reset_registers();
  [[nodiscard]] std::uint16_t word_at(std::uint8_t address) const;
  void set_word(std::uint8_t address, std::uint16_t value);
  [[nodiscard]] std::uint16_t read(std::uint8_t address);
  void write(std::uint8_t address, std::uint8_t value);
  void load_burst();

  Part part_;
  std::array<std::uint16_t, kBurstWords> burst_{};
  std::size_t burst_at_ = kNoBurst;  ///< word of the burst that comes next
  std::uint16_t reply_ = 0;
  std::uint16_t status_ = 0;
};

/// The parts, by the names in the table of chips.
class SimulatedAdis16470 : public SimulatedAdis16475 {
 public:
  static constexpr std::string_view kName = "adis16470";
  explicit SimulatedAdis16470(const SimulatedClock& clock)
      : SimulatedAdis16475(clock, {16470, 0x00, 10.0, 800.0}) {}
};
class SimulatedAdis16475Part1 : public SimulatedAdis16475 {
 public:
  static constexpr std::string_view kName = "adis16475-1";
  explicit SimulatedAdis16475Part1(const SimulatedClock& clock)
      : SimulatedAdis16475(clock, {16475, 0x03, 160.0, 4000.0}) {}
};
class SimulatedAdis16475Part2 : public SimulatedAdis16475 {
 public:
  static constexpr std::string_view kName = "adis16475-2";
  explicit SimulatedAdis16475Part2(const SimulatedClock& clock)
      : SimulatedAdis16475(clock, {16475, 0x07, 40.0, 4000.0}) {}
};
class SimulatedAdis16475Part3 : public SimulatedAdis16475 {
 public:
  static constexpr std::string_view kName = "adis16475-3";
  explicit SimulatedAdis16475Part3(const SimulatedClock& clock)
      : SimulatedAdis16475(clock, {16475, 0x0F, 10.0, 4000.0}) {}
};
static_assert(WordChip<SimulatedAdis16470>);

}  // namespace zerorate::hal::sim

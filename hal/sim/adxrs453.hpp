/// @file
/// An ADXRS453 at the level of its frames, fed with physical values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/clock.hpp"

namespace zerorate::hal::sim {

/// The chip (Analog Devices, ADXRS453 rev. B): replies one frame late, parities, sequence bits, the
/// status field, fault bits and the CHK sequence, registers, temperature, power-up time, rounding
/// and clipping.
///
/// Not modelled: the continuous self-test, quadrature, filters, the registers LOCST and HICST (they
/// read as 0), writes (there is nothing to write; they are refused).
///
/// measure() sets the chip's inputs; it converts whenever it is asked. Its axis is z.
class SimulatedAdxrs453 {
 public:
  static constexpr std::string_view kName = "adxrs453";

  /// @param clock the simulation's time; must outlive the chip
  explicit SimulatedAdxrs453(const SimulatedClock& clock) : clock_(&clock) { cycle_power(); }

  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature) {
    rate_ = rate[2];
    temperature_ = temperature;
  }

  [[nodiscard]] bool is_powered() const;
  /// Commands that the chip refused: bad parity, writes, reads of what is not there.
  [[nodiscard]] std::size_t reserved_writes() const { return refused_commands_; }

  /// Interrupted supply: everything is as after power-on.
  void cycle_power();
  /// An upset or a fault: flips bits of one register, without a bus. A fault stays until the fault
  /// registers are read.
  void upset(std::uint8_t address, std::uint8_t flipped_bits) {
    registers_.at(address) ^= flipped_bits;
  }

  // The bus's side (FrameChip).
  std::uint32_t exchange_frame(std::uint32_t command);

 private:
  [[nodiscard]] std::uint32_t respond(std::uint32_t command);
  [[nodiscard]] std::uint32_t sensor_data(std::uint32_t command);
  [[nodiscard]] std::uint32_t read(std::uint8_t address);
  [[nodiscard]] std::uint32_t refuse(unsigned reason);
  [[nodiscard]] std::uint8_t faults();

  const SimulatedClock* clock_;
  std::array<std::uint8_t, 18> registers_{};
  core::AngularRate rate_;
  core::Temperature temperature_ = core::Temperature::from_degc(25.0F);
  std::uint32_t reply_ = 0;
  core::Instant powered_at_;
  core::Instant checked_at_;     ///< when CHK was asserted, or its faults were last shown
  unsigned checks_to_show_ = 0;  ///< replies that still show the faults that CHK asserted
  std::size_t refused_commands_ = 0;
};
static_assert(FrameChip<SimulatedAdxrs453>);

}  // namespace zerorate::hal::sim

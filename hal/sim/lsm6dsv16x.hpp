/// @file
/// An LSM6DSV16X at the level of its registers, fed with physical values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// The chip as ST's lsm6dsv16x-pid describes it, a gyro that has an accelerometer beside it:
/// identity, reset values, software reset, turn-on transients, rounding and saturation, block data
/// update, data-ready, FIFO with tags, watermark and overrun, temperature, oscillator trim, INT1,
/// sleep.
///
/// Not modelled: the accelerometer without the gyro or at another rate (it converts with the gyro),
/// its second channel and user offsets, filters, high-accuracy rates, low-power mode, FIFO
/// compression, time stamps, the other banks, EIS, OIS, Qvar.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedLsm6dsv16x : public SimulatedStModule {
 public:
  static constexpr std::string_view kName = "lsm6dsv16x";

  /// @param clock the simulation's time; must outlive the chip
  /// @param trim INTERNAL_FREQ_FINE: the oscillator is 0.13 % faster for each count
  explicit SimulatedLsm6dsv16x(const SimulatedClock& clock, std::int8_t trim = 0)
      : SimulatedStModule(clock, kDataPath), trim_(trim) {
    reset_registers();
  }

  /// One conversion: rounds to the LSB, saturates at 16 bits, raises data-ready, fills the FIFO.
  /// Does nothing while the gyro is powered down, asleep or in reset.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  [[nodiscard]] bool is_powered() const;
  [[nodiscard]] bool is_accelerometer_powered() const;
  /// Nominal period of the configured rate, trim included; zero when powered down.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power() { reset_registers(); }

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);

 private:
  static constexpr DataPath kDataPath{.fifo_words = 256,  // 1.5 kbyte of data, six bytes a word
                                      .watermark_high_bit = 0,
                                      .turn_on_time = core::Duration::milliseconds(30)};

  void reset_registers();
  void batch(bool has_acceleration);

  std::int8_t trim_;
};
static_assert(RegisterChip<SimulatedLsm6dsv16x>);

}  // namespace zerorate::hal::sim

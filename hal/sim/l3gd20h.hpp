/// @file
/// An L3GD20H or a relative at the level of its registers, fed with physical values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// The chip (ST DocID023469): identity, reset values, reboot of the trimming, software reset and
/// low rates (L3GD20H), turn-on transient, rounding and saturation, data-ready with overrun flags,
/// FIFO that stops or streams, with watermark and overrun, temperature, DRDY/INT2, bursts whose
/// increment is asked for in the address.
///
/// Not modelled: filters, REFERENCE, thresholds and INT1, self-test, triggers of the FIFO (they
/// behave as bypass), block data update (a conversion never falls into a burst), the big-endian
/// order of the bytes.
///
/// The chip has no oscillator of its own: each call of measure() is one conversion, at the time of
/// the clock.
class SimulatedL3gd20h : public SimulatedRegisters<64> {
 public:
  static constexpr std::string_view kName = "l3gd20h";
  static constexpr std::uint8_t kIdentityL3g4200d = 0xD3;
  static constexpr std::uint8_t kIdentityL3gd20 = 0xD4;
  static constexpr std::uint8_t kIdentityL3gd20h = 0xD7;

  /// @param clock the simulation's time; must outlive the chip
  /// @param identity of WHO_AM_I
  explicit SimulatedL3gd20h(const SimulatedClock& clock, std::uint8_t identity = kIdentityL3gd20h)
      : SimulatedRegisters(clock), identity_(identity) {
    reset_registers();
  }

  /// One conversion: rounds to the LSB, saturates at 16 bits, raises data-ready, fills the FIFO.
  /// Does nothing while the chip is powered down or boots.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);

  /// True if some axis is on.
  [[nodiscard]] bool is_powered() const;
  /// Nominal period of the configured rate; zero when powered down.
  [[nodiscard]] core::Duration sample_period() const;

  /// Interrupted supply: everything is as after power-on.
  void cycle_power() { reset_registers(); }

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 private:
  using Frame = std::array<std::int16_t, 3>;

  void reset_registers();
  [[nodiscard]] bool is_fifo_on() const;
  void push(const Frame& frame);
  std::uint8_t read_output(std::uint8_t address);
  std::uint8_t take_fifo_src();
  void drive_int2();

  std::uint8_t identity_;
  std::deque<Frame> fifo_;
  Frame newest_{};
  bool has_overwritten_ = false;
  core::Instant powered_at_;
};
static_assert(RegisterChip<SimulatedL3gd20h>);

class SimulatedL3gd20 : public SimulatedL3gd20h {
 public:
  static constexpr std::string_view kName = "l3gd20";
  explicit SimulatedL3gd20(const SimulatedClock& clock)
      : SimulatedL3gd20h(clock, kIdentityL3gd20) {}
};

class SimulatedL3g4200d : public SimulatedL3gd20h {
 public:
  static constexpr std::string_view kName = "l3g4200d";
  explicit SimulatedL3g4200d(const SimulatedClock& clock)
      : SimulatedL3gd20h(clock, kIdentityL3g4200d) {}
};

}  // namespace zerorate::hal::sim

/// @file
/// An LSM6DSL or LSM6DS3TR-C at the level of its registers: an LSM6DSO whose FIFO has no tags.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string_view>

#include "core/base/units.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// The older LSM6DSL (DocID028475): its own addresses may be written, the oscillator has no trim
/// register, and the FIFO has no tags. A conversion adds three words with the rates, three with the
/// accelerations and three with the time stamp, in this order. FIFO_CTRL2 to 5 switch each of the
/// three groups on.
///
/// Not modelled: decimation into the FIFO (any factor but 0 counts as 1), FIFO modes but FIFO and
/// continuous, external sensors, the step counter.
class SimulatedLsm6dsl : public SimulatedLsm6dso {
 public:
  static constexpr std::string_view kName = "lsm6dsl";
  explicit SimulatedLsm6dsl(const SimulatedClock& clock)
      : SimulatedLsm6dso(clock, 0, 0x6A, kNoTaggedWords) {}

  /// One conversion, see SimulatedLsm6dso.
  void measure(const std::array<core::AngularRate, 3>& rate, core::Temperature temperature);
  void cycle_power();

  // The bus's side (RegisterChip).
  std::uint8_t read_register(std::uint8_t address);
  void write_register(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t next_address(std::uint8_t address) const;

 private:
  static constexpr std::size_t kNoTaggedWords = 0;

  struct Word {
    std::int16_t value = 0;
    std::uint8_t place = 0;  ///< in the pattern
  };

  [[nodiscard]] unsigned fifo_mode() const;
  [[nodiscard]] std::size_t watermark() const;
  void batch();
  void push(const Word& word);
  void clear_fifo();
  [[nodiscard]] std::uint8_t flags_and_level() const;
  std::uint8_t read_fifo(std::uint8_t address);
  void drive_watermark();

  std::deque<Word> words_;
  bool has_lost_words_ = false;
};
static_assert(RegisterChip<SimulatedLsm6dsl>);

/// The successor of the LSM6DSL, with the same registers.
class SimulatedLsm6ds3trC : public SimulatedLsm6dsl {
 public:
  static constexpr std::string_view kName = "lsm6ds3tr-c";
  using SimulatedLsm6dsl::SimulatedLsm6dsl;
};

}  // namespace zerorate::hal::sim

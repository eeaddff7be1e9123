/// @file
/// Any of the simulated chips with its bus and its driver, as one GyroSource.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "drivers/common/any_gyro.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/data_ready_pin.hpp"

namespace zerorate::evaluate {

/// A gyro whose read() returns the sample given to measure(), rounded as the chip rounds.
class SimulatedGyro : public drivers::AnyGyro {
 public:
  /// One conversion of the chip, at the time of its clock.
  virtual void measure(const core::GyroSample& sample) = 0;
  /// Data-ready pin of the chip's conversions; a chip without a pin never drives it.
  virtual hal::sim::DataReadyPin& interrupt() = 0;
};

/// A simulated chip and how its gyro is made: a line of the table of chips.
struct SimulatedChip {
  std::string_view name;
  std::size_t axis_count;  ///< 3, or 1, which is z and comes out on all three
  bool has_accelerometer;
  /// In data-ready mode and over SPI, at the driver's default ranges.
  /// @param clock must outlive the gyro
  /// @param reads_accelerometer whether the driver reads the accelerometer, which the chip must
  /// have
  std::unique_ptr<SimulatedGyro> (*make)(const hal::sim::SimulatedClock& clock,
                                         bool reads_accelerometer);
};

/// All chips, by name.
[[nodiscard]] std::span<const SimulatedChip> simulated_chips();
/// Throws std::invalid_argument where there is none of that name.
[[nodiscard]] const SimulatedChip& find_simulated_chip(std::string_view name);

}  // namespace zerorate::evaluate

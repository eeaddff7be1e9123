/// @file
/// Any of the simulated chips with its bus and its driver, as one GyroSource.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "drivers/common/any_gyro.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/data_ready_pin.hpp"

namespace zerorate::evaluate {

enum class Chip : std::uint8_t { lsm6dso, icm42688, bmi088, adxrs453 };
inline constexpr std::array kAllChips = {Chip::lsm6dso, Chip::icm42688, Chip::bmi088,
                                         Chip::adxrs453};
[[nodiscard]] std::string_view name(Chip chip);

/// How many axes the chip has: 3, or 1, which is z and comes out on all three.
[[nodiscard]] std::size_t axis_count(Chip chip);

/// A gyro whose read() returns the rate given to measure(), rounded as the chip rounds.
class SimulatedGyro : public drivers::AnyGyro {
 public:
  /// One conversion of the chip, at the time of its clock.
  virtual void measure(const std::array<core::AngularRate, 3>& rate,
                       core::Temperature temperature) = 0;
  /// Data-ready pin of the chip's conversions; a chip without a pin never drives it.
  virtual hal::sim::DataReadyPin& interrupt() = 0;
};

/// In data-ready mode and over SPI, at the driver's default range.
/// @param clock must outlive the gyro
[[nodiscard]] std::unique_ptr<SimulatedGyro> make_simulated_gyro(
    Chip chip, const hal::sim::SimulatedClock& clock);

}  // namespace zerorate::evaluate

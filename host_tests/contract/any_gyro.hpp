/// @file
/// Gyros on their buses behind one type, so that the suites over all of them are compiled once.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/samples/gyro_sample.hpp"
#include "drivers/common/gyro_source.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/data_ready_pin.hpp"
#include "hal/testing/fault_injector.hpp"
#include "host_tests/support/gyro_description.hpp"

namespace zerorate::contract {

using Rates = std::array<core::AngularRate, 3>;
using Force = std::array<core::Acceleration, 3>;

/// Settings that a driver gets.
struct Setting {
  enum class Kind : std::uint8_t { usual, data_ready, fifo, range };
  Kind kind = Kind::usual;
  std::size_t range = 0;  ///< index into AnyGyro::ranges
};
inline constexpr Setting kFifo{Setting::Kind::fifo};
inline constexpr std::array kModes{Setting{Setting::Kind::data_ready}, kFifo};

/// A driver, a fault injector, a bus and a simulated chip, wired together: support::GyroRig of any
/// wiring.
class AnyRig {
 public:
  using Done = core::Result<void, drivers::DriverError>;
  using Count = core::Result<std::size_t, drivers::DriverError>;

  AnyRig() = default;
  AnyRig(const AnyRig&) = delete;
  AnyRig& operator=(const AnyRig&) = delete;
  virtual ~AnyRig() = default;

  virtual hal::sim::SimulatedClock& clock() = 0;
  virtual hal::testing::Faults& faults() = 0;

  /// The driver: one call of start() now; then as often as it is not ready, for a second; and the
  /// power-up time besides.
  virtual Done start_once() = 0;
  virtual Done start() = 0;
  virtual Done start_and_settle() = 0;
  virtual Count read(core::Instant now, std::span<core::GyroSample> out) = 0;
  virtual Done verify_next() = 0;
  [[nodiscard]] virtual core::Duration sample_period() const = 0;

  /// The chip's next conversion, and one after another period.
  virtual void measure(const Rates& rate, core::Temperature temperature) = 0;
  virtual void upset(std::uint8_t address, std::uint8_t flipped_bits) = 0;
  virtual void cycle_power() = 0;
  [[nodiscard]] virtual bool is_powered() const = 0;
  [[nodiscard]] virtual std::size_t reserved_writes() const = 0;
  /// Null where the chip has no such pin.
  virtual hal::sim::DataReadyPin* interrupt() = 0;
  /// True if the driver takes a chip whose identity is off by these bits for a relative of it.
  virtual bool is_relative(std::uint8_t flipped_bits) = 0;
  /// Where the chip has an accelerometer.
  virtual void set_specific_force(const Force& force, core::Acceleration noise = {}) = 0;
  virtual void lose_accelerations(int conversions) = 0;

  void sample(const Rates& rate, core::Temperature temperature = core::Temperature::from_degc(25)) {
    clock().advance(sample_period());
    measure(rate, temperature);
  }
  Count read(std::span<core::GyroSample> out) { return read(clock().now(), out); }
  /// Reads until there is no more, into buffers of 16 samples as the node's loop does.
  std::vector<core::GyroSample> read_all();
};

/// Full scale by its LSB, and how far the tests go.
struct AnyRange {
  float lsb_dps = 0.0F;
  float span_dps = 0.0F;
};

/// A chip in a wiring, with what a test has to know of it (simulated_gyros.hpp).
struct AnyGyro {
  std::string name;
  std::vector<AnyRange> ranges;
  float lsb_dps = 0.0F;
  float full_scale_dps = 0.0F;
  float lowest_raw = 0.0F;
  float temperature_lsb = 0.0F;  ///< 0: none
  bool is_single_axis = false;   ///< measures z and gives it on all axes
  bool frames_are_marked = false;
  bool is_sampled_by_reading = false;
  bool reading_releases_pin = true;
  std::size_t read_transactions = 2;  ///< least number, in a read that gives a sample
  std::size_t verify_transactions = 0;
  std::size_t fifo_capacity = 0;  ///< 0: none
  bool has_watermark = false;
  std::uint8_t identity = 0;
  std::span<const support::ConfiguredBits> configured;
  core::Duration start_time;
  core::Duration earliest;
  core::Duration latest;
  float lsb_g = 0.0F;  ///< 0: no accelerometer
  float range_g = 0.0F;
  bool can_lose_acceleration = false;
  bool acceleration_is_marked = false;
  std::unique_ptr<AnyRig> (*make)(Setting, core::Instant begin) = nullptr;
  /// Rig with the driver of the gyro alone; null without an accelerometer.
  std::unique_ptr<AnyRig> (*make_plain)(Setting, core::Instant begin) = nullptr;

  [[nodiscard]] std::unique_ptr<AnyRig> rig(Setting setting = {}, core::Instant begin = {}) const {
    return make(setting, begin);
  }
  /// Rate that is expected on an axis.
  [[nodiscard]] float expected_dps(const Rates& sent, std::size_t axis) const {
    return sent.at(is_single_axis ? 2 : axis).in(core::deg_per_s);
  }
  friend std::ostream& operator<<(std::ostream& out, const AnyGyro& gyro) {
    return out << gyro.name;
  }
};

/// The chip and its wiring, in the name of a test.
inline std::string name_of(const ::testing::TestParamInfo<AnyGyro>& gyro) {
  return gyro.param.name;
}

/// Every chip in every wiring, or in one where it differs from another by its name.
[[nodiscard]] const std::vector<AnyGyro>& all_gyros();
[[nodiscard]] std::vector<AnyGyro> gyros_with_fifo();
[[nodiscard]] std::vector<AnyGyro> gyros_with_acceleration();

}  // namespace zerorate::contract

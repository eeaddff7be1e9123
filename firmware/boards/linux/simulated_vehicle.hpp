/// @file
/// A vehicle that is not there: `chip = "simulated"`, to try the node without hardware.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <random>
#include <span>

#include "drivers/common/any_gyro.hpp"
#include "drivers/lsm6dso/driver.hpp"
#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/hardware.hpp"
#include "firmware/boards/linux/process/event.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/odometer.hpp"

namespace zerorate::linux_node {

/// Motion of the simulated vehicle at one time.
struct SimulatedMotion {
  core::AngularRate turn;  ///< about the axis z
  bool is_moving = false;
};

/// Temperature of a chip that warms up by 4 K after the start, with a time constant of 5 min.
[[nodiscard]] core::Temperature temperature_at(core::Duration time);

/// Twenty seconds at rest, forty in bends of at most 10 deg/s, again and again.
/// @param time  since the start
[[nodiscard]] SimulatedMotion motion_at(core::Duration time);

/// A simulated LSM6DSO, read by its driver, with the white noise of the configured model, a bias
/// that wanders, and an odometer of ten pulses a second. The accelerometer, where it is read,
/// measures gravity alone, along z, and noise. Samples come in real time, or faster by the
/// configured factor. Uses the heap.
class SimulatedVehicle final : public Hardware {
 public:
  explicit SimulatedVehicle(const Configuration& configuration);

  [[nodiscard]] drivers::AnyGyro& gyro() override { return *gyro_; }
  core::Result<hal::PulseBatch, hal::BusError> read_pulses(
      std::span<core::Instant> stamps) override {
    return speed_ ? speed_->read_pulses(stamps) : odometer_.read_pulses(stamps);
  }
  HardwareReasons reasons(drivers::DriverErrorCode /*code*/) override {
    return {.gyro = {}, .odometer_error_number = speed_ ? speed_->error_number() : 0};
  }
  [[nodiscard]] std::optional<Reference> next_reference() override {
    return references_ ? references_->next(now()) : std::nullopt;
  }
  [[nodiscard]] int reference_error_number() const override {
    return references_ ? references_->error_number() : 0;
  }
  std::optional<core::Instant> take_edge() override { return chip_.interrupt().take_edge(); }
  [[nodiscard]] core::Instant now() const override;
  void wait() override;
  void wake() override { wake_.signal(); }

 private:
  using Spi = hal::sim::SimulatedSpiDevice<hal::sim::SimulatedLsm6dso>;

  [[nodiscard]] std::unique_ptr<drivers::AnyGyro> make_gyro(const GyroSettings& wanted);
  void measure();

  double time_factor_;
  bool drives_;
  hal::sim::SimulatedClock clock_;
  core::Instant begin_;
  core::Instant next_sample_;
  core::Instant next_pulse_;
  hal::sim::SimulatedLsm6dso chip_{clock_};
  hal::sim::SimulatedOdometer odometer_;
  std::optional<SpeedSource> speed_;  ///< in its place
  std::optional<ReferenceSource> references_;
  std::unique_ptr<drivers::AnyGyro> gyro_;
  std::mt19937_64 random_{1};
  std::normal_distribution<float> noise_;
  std::array<float, 3> bias_rad_s_;
  Event wake_;
};

/// Hardware that the configuration names.
[[nodiscard]] std::unique_ptr<Hardware> make_hardware(const Configuration& configuration);

}  // namespace zerorate::linux_node

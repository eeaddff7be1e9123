/// @file
/// The Linux node's hardware as a simulated chip, an odometer and a clock, with faults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/hardware.hpp"
#include "hal/sim/odometer.hpp"
#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/support/simulated_gyros.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::linux_node {

/// Each wait() lets one sample period pass and the chip measure once. What the simulation allocates
/// is counted, so that a test can leave it out.
class SimulatedHardware final : public Hardware, public drivers::AnyGyro {
 private:
  template <class Action>
  auto excused(Action action) {
    const support::AllocationCounter counter;
    auto result = action();
    allocations += counter.count();
    return result;
  }

 public:
  [[nodiscard]] drivers::AnyGyro& gyro() override { return *this; }
  core::Result<void, drivers::DriverError> start(core::Instant now) override {
    return excused([&] { return rig.driver.start(now); });
  }
  core::Result<std::size_t, drivers::DriverError> read(
      core::Instant now, std::span<drivers::GyroSample> out) override {
    return excused([&] { return rig.driver.read(now, out); });
  }
  core::Result<void, drivers::DriverError> verify_next() override {
    return excused([&] { return rig.driver.verify_next(); });
  }
  [[nodiscard]] core::Duration sample_period() const override { return rig.driver.sample_period(); }
  [[nodiscard]] core::AngularRate lsb() const override { return rig.driver.lsb(); }
  [[nodiscard]] bool is_batched() const override { return rig.driver.is_batched(); }
  core::Result<hal::PulseBatch, hal::BusError> read_pulses(
      std::span<core::Instant> stamps) override {
    if (odometer_fails) return core::Unexpected{hal::BusError::io};
    return excused([&] { return odometer.read_pulses(stamps); });
  }
  std::optional<core::Instant> take_edge() override { return rig.chip.interrupt().take_edge(); }
  [[nodiscard]] std::optional<Reference> next_reference() override {
    return std::exchange(reference, std::nullopt);
  }
  [[nodiscard]] core::Instant now() const override { return rig.clock.now(); }
  void wake() override {}

  void wait() override {
    excused([&] {
      support::Rates rates{rate, rate, rate};
      for (std::size_t i = 0; i < rates.size(); ++i) {
        const random::RandomStream noise{1, i};
        rates.at(i) = rates.at(i) + sigma * static_cast<float>(noise.normal(measured));
      }
      ++measured;
      rig.sample(rates);
      if (is_moving) odometer.pulse(rig.clock.now());
      return 0;
    });
  }

  support::GyroRig<support::OverSpi<support::Lsm6dso>> rig{
      {.rate = drivers::lsm6dso::OutputDataRate::hz_104}, core::Instant::from_ns(1'000'000'000)};
  hal::sim::SimulatedOdometer odometer;
  core::AngularRate rate = core::deg_per_s(0.35F);
  core::AngularRate sigma = core::deg_per_s(0.04F);
  std::int64_t measured = 0;
  std::optional<Reference> reference;  ///< the next one
  bool is_moving = false;
  bool odometer_fails = false;
  std::size_t allocations = 0;
};

inline constexpr const char* kMinimalConfiguration = R"(schema = "zerorate.daemon/1"
[gyro]
chip = "lsm6dso"
bus = "spi"
device = "/dev/spidev0.0"
rate_hz = 104
full_scale_dps = 250
[odometer]
chip = "/dev/gpiochip0"
line = 24
)";

}  // namespace zerorate::linux_node

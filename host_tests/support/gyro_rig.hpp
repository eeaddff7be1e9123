/// @file
/// A driver, a fault injector, a bus and a simulated chip, wired together.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/common/gyro_source.hpp"
#include "hal/sim/clock.hpp"
#include "hal/testing/fault_injector.hpp"

namespace zerorate::support {

using Rates = std::array<core::AngularRate, 3>;

inline bool is_waiting(const core::Result<void, drivers::DriverError>& started) {
  return !started && started.error().code == drivers::DriverErrorCode::not_ready;
}

/// @tparam Wiring names the chip and says how it is attached (simulated_gyros.hpp)
template <class Wiring>
struct GyroRig {
  using Gyro = typename Wiring::Gyro;
  using Driver = typename Wiring::Driver;
  static_assert(drivers::GyroSource<Driver>);

  /// @param begin what the clock shows first
  /// @param chip_options what the simulated chip takes besides the clock
  template <class... ChipOptions>
  explicit GyroRig(typename Gyro::Settings settings = {}, core::Instant begin = {},
                   ChipOptions... chip_options)
      : clock(begin),
        chip(clock, chip_options...),
        driver(Wiring::link(faults), prepared(settings)) {}

  /// Settings with the file that the simulated chip takes, where it needs one.
  static typename Gyro::Settings prepared(typename Gyro::Settings settings) {
    if constexpr (requires { settings.config_file; }) {
      settings.config_file = Gyro::Simulated::config_file();
    }
    return settings;
  }

  /// Calls start() every millisecond until it gives something else than not_ready, for a second.
  core::Result<void, drivers::DriverError> start() {
    auto started = driver.start(clock.now());
    for (int ms = 0; ms < 1000 && is_waiting(started); ++ms) {
      clock.advance(core::Duration::milliseconds(1));
      started = driver.start(clock.now());
    }
    return started;
  }

  /// Starts and lets the power-up time pass.
  core::Result<void, drivers::DriverError> start_and_settle() {
    const auto started = start();
    clock.advance(core::Duration::seconds(6));
    return started;
  }

  /// The chip's next conversion, one period later.
  void sample(const Rates& rate, core::Temperature temperature = core::Temperature::from_degc(25)) {
    clock.advance(driver.sample_period());
    chip.measure(rate, temperature);
  }

  core::Result<std::size_t, drivers::DriverError> read(std::span<core::GyroSample> out) {
    return driver.read(clock.now(), out);
  }

  hal::sim::SimulatedClock clock;
  typename Gyro::Simulated chip;
  typename Wiring::Bus bus = Wiring::attach(chip);
  hal::testing::FaultInjector<typename Wiring::Bus> faults{bus};
  Driver driver;
};

}  // namespace zerorate::support

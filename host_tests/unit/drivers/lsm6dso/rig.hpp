/// @file
/// A driver, a fault injector, a bus and a simulated chip, wired over SPI or I2C.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "drivers/common/register_bus.hpp"
#include "drivers/lsm6dso/driver.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/i2c.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/spi.hpp"
#include "hal/testing/fault_injector.hpp"

namespace zerorate::drivers {

using Rates = std::array<core::AngularRate, 3>;

/// Which bus a rig uses.
struct OverSpi {
  using Bus = hal::sim::SimulatedSpiDevice<hal::sim::SimulatedLsm6dso>;
  using Registers = SpiRegisters<hal::testing::FaultInjector<Bus>>;
  static Bus attach(hal::sim::SimulatedLsm6dso& chip) { return Bus{chip}; }
  static Registers registers(hal::testing::FaultInjector<Bus>& bus) { return Registers{bus}; }
};
struct OverI2c {
  using Bus = hal::sim::SimulatedI2cBus<hal::sim::SimulatedLsm6dso>;
  using Registers = I2cRegisters<hal::testing::FaultInjector<Bus>>;
  static Bus attach(hal::sim::SimulatedLsm6dso& chip) { return Bus{chip, lsm6dso::kAddressSa0Low}; }
  static Registers registers(hal::testing::FaultInjector<Bus>& bus) {
    return Registers{bus, lsm6dso::kAddressSa0Low};
  }
};

template <class Wiring>
struct Rig {
  explicit Rig(lsm6dso::Settings settings = {}, std::int8_t trim = 0, core::Instant begin = {})
      : clock(begin), chip(clock, trim), driver(Wiring::registers(faults), settings) {}

  /// Calls start() until it gives something else than not_ready, at most ten times.
  core::Result<void, DriverError> start() {
    auto started = driver.start(clock.now());
    for (int i = 0; i < 10 && !started && started.error().code == DriverErrorCode::not_ready; ++i) {
      clock.advance(core::Duration::microseconds(20));
      started = driver.start(clock.now());
    }
    return started;
  }

  /// Starts and lets the power-up time pass.
  core::Result<void, DriverError> start_and_settle() {
    const auto started = start();
    clock.advance(core::Duration::seconds(6));
    return started;
  }

  /// The chip's next conversion, one period later.
  void sample(const Rates& rate, core::Temperature temperature = core::Temperature::from_degc(25)) {
    clock.advance(chip.sample_period());
    chip.measure(rate, temperature);
  }

  core::Result<std::size_t, DriverError> read(std::span<GyroSample> out) {
    return driver.read(clock.now(), out);
  }

  hal::sim::SimulatedClock clock;
  hal::sim::SimulatedLsm6dso chip;
  typename Wiring::Bus bus = Wiring::attach(chip);
  hal::testing::FaultInjector<typename Wiring::Bus> faults{bus};
  Lsm6dso<typename Wiring::Registers> driver;
};
static_assert(GyroSource<Lsm6dso<OverSpi::Registers>>);
static_assert(GyroSource<Lsm6dso<OverI2c::Registers>>);

}  // namespace zerorate::drivers

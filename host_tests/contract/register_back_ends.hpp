/// @file
/// The back ends that the contract suite runs over, each with a chip of 8-bit registers behind it.
///
/// A back end is told beforehand what is going to be asked and what the chip holds: a simulated one
/// prepares its chip, a scripted one its script.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/common/register_bus.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/i2c.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/spi.hpp"
#include "hal/testing/fault_injector.hpp"
#include "hal/testing/scripted_bus.hpp"

namespace zerorate::contract {

using Bytes = std::vector<std::uint8_t>;
inline constexpr hal::I2cAddress kDevice{0x6A};

/// A chip behind a simulated SPI device.
struct SimulatedSpi {
  void prepare_read(std::uint8_t first, const Bytes& values) { fill(chip, first, values); }
  void prepare_write(std::uint8_t, std::uint8_t) {}
  void prepare_exchange(const Bytes& sent, const Bytes& answer) {
    fill(chip, sent[0] & 0x7FU, {answer[1]});
  }
  void prepare_empty() {}
  drivers::SpiRegisters<hal::sim::SimulatedSpiDevice<hal::sim::SimulatedLsm6dso>> registers() {
    return drivers::SpiRegisters{bus};
  }
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    return bus.transaction(operations);
  }
  static void fill(hal::sim::SimulatedLsm6dso& chip, std::uint8_t first, const Bytes& values) {
    for (const std::uint8_t value : values) chip.write_register(first++, value);
  }

  hal::sim::SimulatedClock clock;
  hal::sim::SimulatedLsm6dso chip{clock};
  hal::sim::SimulatedSpiDevice<hal::sim::SimulatedLsm6dso> bus{chip};
};

/// A chip behind a simulated I2C bus.
struct SimulatedI2c {
  void prepare_read(std::uint8_t first, const Bytes& values) {
    SimulatedSpi::fill(chip, first, values);
  }
  void prepare_write(std::uint8_t, std::uint8_t) {}
  void prepare_empty() {}
  drivers::I2cRegisters<hal::sim::SimulatedI2cBus<hal::sim::SimulatedLsm6dso>> registers() {
    return drivers::I2cRegisters{bus, kDevice};
  }
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    return bus.transaction(kDevice, operations);
  }

  hal::sim::SimulatedClock clock;
  hal::sim::SimulatedLsm6dso chip{clock};
  hal::sim::SimulatedI2cBus<hal::sim::SimulatedLsm6dso> bus{chip, kDevice};
};

/// A script on SPI.
struct ScriptedSpi {
  void prepare_read(std::uint8_t first, const Bytes& values) {
    bus.expect({hal::testing::writes({static_cast<std::uint8_t>(first | 0x80U)}),
                hal::testing::reads(values)});
  }
  void prepare_write(std::uint8_t address, std::uint8_t value) {
    bus.expect({hal::testing::writes({address, value})});
  }
  void prepare_exchange(const Bytes& sent, const Bytes& answer) {
    bus.expect({hal::testing::exchanges(sent, answer)});
  }
  void prepare_empty() { bus.expect({}); }
  drivers::SpiRegisters<hal::testing::ScriptedSpiDevice> registers() {
    return drivers::SpiRegisters{bus};
  }
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    return bus.transaction(operations);
  }

  hal::testing::ScriptedSpiDevice bus;
};

/// A script on I2C.
struct ScriptedI2c {
  void prepare_read(std::uint8_t first, const Bytes& values) {
    bus.expect(kDevice, {hal::testing::writes({first}), hal::testing::reads(values)});
  }
  void prepare_write(std::uint8_t address, std::uint8_t value) {
    bus.expect(kDevice, {hal::testing::writes({address, value})});
  }
  void prepare_empty() { bus.expect(kDevice, {}); }
  drivers::I2cRegisters<hal::testing::ScriptedI2cBus> registers() {
    return drivers::I2cRegisters{bus, kDevice};
  }
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    return bus.transaction(kDevice, operations);
  }

  hal::testing::ScriptedI2cBus bus;
};

/// A back end behind a fault injector without faults, which must change nothing.
struct InjectedSpi : SimulatedSpi {
  drivers::SpiRegisters<hal::testing::FaultInjector<decltype(SimulatedSpi::bus)>> registers() {
    return drivers::SpiRegisters{injector};
  }
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    return injector.transaction(operations);
  }

  hal::testing::FaultInjector<decltype(SimulatedSpi::bus)> injector{bus};
};

/// The same on I2C.
struct InjectedI2c : SimulatedI2c {
  drivers::I2cRegisters<hal::testing::FaultInjector<decltype(SimulatedI2c::bus)>> registers() {
    return drivers::I2cRegisters{injector, kDevice};
  }
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    return injector.transaction(kDevice, operations);
  }

  hal::testing::FaultInjector<decltype(SimulatedI2c::bus)> injector{bus};
};

}  // namespace zerorate::contract

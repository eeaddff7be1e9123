/// @file
/// The back ends that the contract suite runs over, each with a chip of 8-bit registers behind it.
///
/// A back end is told beforehand what is going to be asked and what the chip holds: a simulated one
/// prepares its chip, a scripted one its script.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/common/register_access.hpp"
#include "hal/linux/i2c_dev.hpp"
#include "hal/linux/spidev.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/testing/fault_injector.hpp"
#include "hal/testing/scripted_bus.hpp"
#include "host_tests/unit/hal/linux/kernel_double.hpp"

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

/// Back end on I2C.
struct InjectedI2c : SimulatedI2c {
  drivers::I2cRegisters<hal::testing::FaultInjector<decltype(SimulatedI2c::bus)>> registers() {
    return drivers::I2cRegisters{injector, kDevice};
  }
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    return injector.transaction(kDevice, operations);
  }

  hal::testing::FaultInjector<decltype(SimulatedI2c::bus)> injector{bus};
};

/// A chip behind spidev, by way of a double of the kernel.
struct LinuxSpi : SimulatedSpi {
  using Device = hal::linux_os::SpidevDevice<hal::linux_os::KernelDouble>;
  LinuxSpi() {
    kernel.spi_device = [this](auto operations) { (void)bus.transaction(operations); };
  }
  drivers::SpiRegisters<Device> registers() { return drivers::SpiRegisters{device}; }
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    return device.transaction(operations);
  }

  hal::linux_os::KernelState kernel;
  Device device{{.device = "/dev/spidev0.0"}, hal::linux_os::KernelDouble{kernel}};
};

/// Back end behind i2c-dev.
struct LinuxI2c : SimulatedI2c {
  using Bus = hal::linux_os::I2cDevBus<hal::linux_os::KernelDouble>;
  LinuxI2c() {
    kernel.i2c_device = [this](auto address, auto operations) {
      return bus.transaction(address, operations).has_value();
    };
  }
  drivers::I2cRegisters<Bus> registers() { return drivers::I2cRegisters{device, kDevice}; }
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    return device.transaction(kDevice, operations);
  }

  hal::linux_os::KernelState kernel;
  Bus device{"/dev/i2c-7", hal::linux_os::KernelDouble{kernel}};
};

}  // namespace zerorate::contract

/// @file
/// Buses that follow a script. For tests only, never in firmware.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/result.hpp"
#include "hal/contract/i2c_bus.hpp"
#include "hal/contract/spi_device.hpp"
#include "hal/testing/bus_script.hpp"

namespace zerorate::hal::testing {

/// An SpiDevice that fails the test when it is used otherwise than scripted:
///
///     ScriptedSpiDevice spi;
///     spi.expect({writes({0x8F}), reads({0x6C})});
///     spi.expect({writes({0x8F}), reads({0x6C})}, FailureAt{1, BusError::timeout});
class ScriptedSpiDevice {
 public:
  void expect(std::vector<ScriptedOperation> operations,
              std::optional<FailureAt> failure = std::nullopt) {
    script_.expect({std::nullopt, std::move(operations), failure});
  }
  core::Result<void, BusError> transaction(std::span<const Operation> operations) {
    return script_.play(std::nullopt, operations);
  }

 private:
  BusScript script_;
};
static_assert(SpiDevice<ScriptedSpiDevice>);

/// A scripted bus as an I2cBus.
class ScriptedI2cBus {
 public:
  void expect(I2cAddress address, std::vector<ScriptedOperation> operations,
              std::optional<FailureAt> failure = std::nullopt) {
    script_.expect({address, std::move(operations), failure});
  }
  core::Result<void, BusError> transaction(I2cAddress address,
                                           std::span<const Operation> operations) {
    return script_.play(address, operations);
  }

 private:
  BusScript script_;
};
static_assert(I2cBus<ScriptedI2cBus>);

}  // namespace zerorate::hal::testing

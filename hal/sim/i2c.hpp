/// @file
/// A simulated chip as the only device of an I2C bus.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/assert.hpp"
#include "core/base/result.hpp"
#include "hal/contract/i2c_bus.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::hal::sim {

/// An I2cBus: the first byte written after a START is the register's address; reads go on from it.
/// Any other device address is not acknowledged.
template <RegisterChip Chip>
class SimulatedI2cBus {
 public:
  SimulatedI2cBus(Chip& chip, I2cAddress address) : chip_(&chip), address_(address) {}

  core::Result<void, BusError> transaction(I2cAddress address,
                                           std::span<const Operation> operations) {
    if (!operations.empty() && address != address_) return core::Unexpected{BusError::nack};
    for (const Operation& operation : operations) {
      ZERORATE_ASSERT(!operation.is_exchange());
      bool is_first = true;
      for (const std::uint8_t byte : operation.bytes()) {
        if (is_first) {
          pointer_ = byte;
        } else {
          chip_->write_register(take_pointer(), byte);
        }
        is_first = false;
      }
      for (std::uint8_t& byte : operation.buffer()) byte = chip_->read_register(take_pointer());
    }
    return {};
  }

 private:
  std::uint8_t take_pointer() {
    const std::uint8_t address = pointer_;
    pointer_ = chip_->next_address(address);
    return address;
  }

  Chip* chip_;
  I2cAddress address_;
  std::uint8_t pointer_ = 0;
};

}  // namespace zerorate::hal::sim

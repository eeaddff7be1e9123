/// @file
/// Why a bus transaction failed. A closed list: a driver may switch over it and be complete.
#pragma once

#include <cstdint>

namespace zerorate::hal {

/// One byte, so that a DriverError that carries it fits in a register.
enum class BusError : std::uint8_t {
  nack,              ///< I2C: the device did not acknowledge its address or a data byte
  arbitration_lost,  ///< I2C: another controller won the bus
  timeout,           ///< the bus did not become free, or a line was held, for the back end's limit
  overrun,           ///< the controller's buffer overflowed or ran empty; bytes were lost
  not_present,       ///< the controller itself is missing, closed or without power
  io,                ///< anything else that the controller or its operating system reports
};

}  // namespace zerorate::hal

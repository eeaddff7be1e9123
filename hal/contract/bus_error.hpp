/// @file
/// Reasons why a bus transaction failed. The list is closed: a driver may switch over it.
#pragma once

#include <cstdint>
#include <string_view>

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

/// For logs and tables.
[[nodiscard]] constexpr std::string_view name(BusError error) {
  switch (error) {
    case BusError::nack:
      return "not acknowledged";
    case BusError::arbitration_lost:
      return "arbitration lost";
    case BusError::timeout:
      return "timeout";
    case BusError::overrun:
      return "overrun";
    case BusError::not_present:
      return "not present";
    case BusError::io:
      return "input/output error";
  }
  return "unknown";
}

}  // namespace zerorate::hal

/// @file
/// From the kernel's error numbers to the contract's reasons: the only place where they are read.
#pragma once

#include <cerrno>
#include <cstdint>

#include "hal/contract/bus_error.hpp"

namespace zerorate::hal::linux_os {

/// Subsystem of the kernel: an error number has another meaning in each of them.
enum class Subsystem : std::uint8_t { spi, i2c, gpio };

/// Sources: Documentation/i2c/fault-codes.rst, drivers/spi/spidev.c, drivers/gpio/gpiolib-cdev.c.
[[nodiscard]] constexpr BusError to_bus_error(int error, Subsystem subsystem) {
  switch (error) {
    case ENXIO:      // I2C: the address was not acknowledged. Elsewhere: no driver behind the node
    case EREMOTEIO:  // some I2C adapters (bcm2835, imx) for any missing acknowledge
      return subsystem == Subsystem::i2c ? BusError::nack : BusError::not_present;
    case EAGAIN:  // I2C: another controller won the bus
      return subsystem == Subsystem::i2c ? BusError::arbitration_lost : BusError::io;
    case EBUSY:      // the bus did not become free within the adapter's limit
    case ETIMEDOUT:  // the transfer did not end within the adapter's limit
    case ETIME:
      return BusError::timeout;
    case ENODEV:     // the controller was unbound or unplugged
    case ENOENT:     // the node is gone from /dev, or has never been there
    case ESHUTDOWN:  // spidev: the device was unbound while the file is open; i2c: suspended
    case EACCES:     // the node is there, but not for us
    case EPERM:
    case EBADF:
      return BusError::not_present;
    case EOVERFLOW:  // the controller's FIFO overflowed
    case ENOBUFS:
      return BusError::overrun;
    default:  // EIO, EPROTO, EINVAL, EMSGSIZE, ...
      return BusError::io;
  }
}

}  // namespace zerorate::hal::linux_os

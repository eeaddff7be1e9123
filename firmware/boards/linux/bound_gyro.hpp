/// @file
/// A driver, its bus and the node in /dev behind it, as one gyro.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "drivers/common/any_gyro.hpp"
#include "drivers/common/register_bus.hpp"
#include "firmware/boards/linux/gyro.hpp"
#include "hal/linux/i2c_dev.hpp"
#include "hal/linux/spidev.hpp"

namespace zerorate::linux_node {

/// Owns the bus that the driver talks to.
/// @tparam Wire    a back end of hal/linux
/// @tparam Driver  a GyroSource
template <class Wire, drivers::GyroSource Driver>
class BoundGyro final : public drivers::AnyGyro {
 public:
  /// @param make_driver makes the driver from a reference to the wire
  template <class Settings, class MakeDriver>
  BoundGyro(Settings wire, MakeDriver make_driver)
      : wire_(std::move(wire)), driver_(make_driver(wire_)) {}

  core::Result<void, drivers::DriverError> start(core::Instant now) override {
    return driver_.start(now);
  }
  core::Result<std::size_t, drivers::DriverError> read(
      core::Instant now, std::span<drivers::GyroSample> out) override {
    return driver_.read(now, out);
  }
  core::Result<void, drivers::DriverError> verify_next() override { return driver_.verify_next(); }
  [[nodiscard]] core::Duration sample_period() const override { return driver_.sample_period(); }
  [[nodiscard]] bool is_batched() const override { return driver_.is_batched(); }

 private:
  Wire wire_;
  Driver driver_;
};

using Spi = hal::linux_os::SpidevDevice<>;
using I2c = hal::linux_os::I2cDevBus<>;

/// A driver that is a template over a register bus, on the bus that the settings name.
/// @param mode  the SPI mode that the chip's README asks for
template <template <class> class Driver, class DriverSettings>
std::unique_ptr<drivers::AnyGyro> make_register_gyro(const GyroSettings& settings,
                                                     std::uint8_t mode,
                                                     const DriverSettings& driver_settings) {
  if (settings.bus == BusKind::spi) {
    using OverSpi = Driver<drivers::SpiRegisters<Spi>>;
    return std::make_unique<BoundGyro<Spi, OverSpi>>(
        hal::linux_os::SpiSettings{settings.device, settings.speed_hz, mode}, [&](Spi& spi) {
          return OverSpi{drivers::SpiRegisters{spi}, driver_settings};
        });
  }
  using OverI2c = Driver<drivers::I2cRegisters<I2c>>;
  return std::make_unique<BoundGyro<I2c, OverI2c>>(settings.device, [&](I2c& i2c) {
    return OverI2c{drivers::I2cRegisters{i2c, hal::I2cAddress{settings.address}}, driver_settings};
  });
}

/// The code that stands at the same place in `codes` as `value` in `values`.
template <class Code, std::size_t N>
Code code_of(double value, std::span<const double> values, const std::array<Code, N>& codes) {
  const auto found = std::ranges::find(values, value);
  return codes.at(static_cast<std::size_t>(found - values.begin()));
}

}  // namespace zerorate::linux_node

/// @file
/// The gyro of this image: an LSM6DSO on SPI, or on I2C.
#pragma once

#include "drivers/common/register_bus.hpp"
#include "drivers/lsm6dso/driver.hpp"
#include "firmware/app/snapshot.hpp"
#include "firmware/boards/pico/node.hpp"
#include "firmware/boards/pico/wiring.hpp"
#include "hal/rp2040/i2c_bus.hpp"
#include "hal/rp2040/spi_device.hpp"

namespace zerorate::pico {

#ifdef ZERORATE_PICO_I2C
using Bus = hal::rp2040::I2c0Bus<kI2cData, kI2cClock>;
using Registers = drivers::I2cRegisters<Bus>;
inline void start_bus() {
  Bus::start();
}
[[nodiscard]] constexpr Registers registers_on(Bus& bus) {
  return {bus, drivers::lsm6dso::kAddressSa0Low};
}
#else
using Bus = hal::rp2040::Spi0Device<kSpiMiso, kSpiChipSelect, kSpiClock, kSpiMosi>;
using Registers = drivers::SpiRegisters<Bus>;
inline void start_bus() {
  Bus::start(8'000'000);  // the chip takes 10 MHz
}
[[nodiscard]] constexpr Registers registers_on(Bus& bus) {
  return Registers{bus};
}
#endif

using Gyro = drivers::Lsm6dso<Registers>;
/// What snapshots are told apart by.
inline constexpr std::uint32_t kSensor = app::sensor_id("lsm6dso");

}  // namespace zerorate::pico

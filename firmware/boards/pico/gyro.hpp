/// @file
/// The pins of the Pico, and the gyro of this image on its bus: SPI, or I2C.
#pragma once

#include "drivers/common/chip.hpp"
#include "drivers/common/register_access.hpp"
#include "firmware/app/snapshot.hpp"
#include "firmware/boards/pico/node.hpp"
#include "hal/rp2040/i2c_bus.hpp"
#include "hal/rp2040/spi_device.hpp"

namespace zerorate::pico {

// docs/how-to/use-a-pico.md draws them.
inline constexpr unsigned kUartTransmit = 0;
inline constexpr unsigned kUartReceive = 1;
inline constexpr unsigned kI2cData = 4;
inline constexpr unsigned kI2cClock = 5;
inline constexpr unsigned kOdometer = 15;
inline constexpr unsigned kSpiMiso = 16;
inline constexpr unsigned kSpiChipSelect = 17;
inline constexpr unsigned kSpiClock = 18;
inline constexpr unsigned kSpiMosi = 19;
inline constexpr unsigned kDataReady = 20;

#ifdef ZERORATE_PICO_I2C
using Bus = hal::rp2040::I2c0Bus<kI2cData, kI2cClock>;
using Wire = drivers::I2cRegisters<Bus>;
inline void start_bus() {
  Bus::start();
}
[[nodiscard]] constexpr Wire wire_on(Bus& bus) {
  return {bus, Chip::kAddresses[0]};
}
#else
inline constexpr auto kSpiPause_us =
    static_cast<std::uint32_t>(drivers::kSpiPauseOf<Chip>.ns() / 1000);
using Bus = hal::rp2040::Spi0Device<kSpiMiso, kSpiChipSelect, kSpiClock, kSpiMosi, kSpiPause_us>;
using Wire = drivers::SpiLink<Chip, Bus>;
inline constexpr auto kSpiMode =
    Chip::kSpiMode == 0 ? hal::rp2040::SpiMode::mode_0 : hal::rp2040::SpiMode::mode_3;
inline void start_bus() {
  Bus::start(kSpiHz, kSpiMode);
}
[[nodiscard]] constexpr Wire wire_on(Bus& bus) {
  return Wire{bus};
}
#endif

using Gyro = Chip::Driver<Wire>;
/// Number by which snapshots of different gyros differ.
inline constexpr std::uint32_t kSensor = app::sensor_id(Chip::kName);

}  // namespace zerorate::pico

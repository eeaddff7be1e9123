#include <array>
#include <cmath>

#include "drivers/adxrs453/driver.hpp"
#include "firmware/boards/linux/bound_gyro.hpp"
#include "firmware/boards/linux/gyro_descriptions.hpp"

namespace zerorate::linux_node {
namespace {

// The chip converts all the time: the rate is how often it is asked. Less folds noise of its 77.5
// Hz.
constexpr std::array kRatesHz{200.0, 250.0, 500.0, 1000.0};
constexpr std::array kFullScalesDps{300.0};

std::unique_ptr<drivers::AnyGyro> make(const GyroSettings& settings) {
  constexpr std::uint8_t kSpiMode = 0;
  using Driver = drivers::Adxrs453<drivers::SpiFrames<Spi>>;
  const auto period =
      core::Duration::nanoseconds(static_cast<std::int64_t>(std::llround(1e9 / settings.rate_hz)));
  return std::make_unique<BoundGyro<Spi, Driver>>(
      hal::linux_os::SpiSettings{settings.device, settings.speed_hz, kSpiMode}, [&](Spi& spi) {
        return Driver{drivers::SpiFrames{spi}, {.sample_period = period}};
      });
}

}  // namespace

ChipDescription describe_adxrs453() {
  return {.name = "adxrs453",
          .rates_hz = kRatesHz,
          .full_scales_dps = kFullScalesDps,
          .addresses = {},
          .highest_speed_hz = 8'080'000,
          .has_fifo = false,
          .counts = 300.0 * 80.0,
          .make = make};
}

}  // namespace zerorate::linux_node

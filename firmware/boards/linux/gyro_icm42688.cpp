#include <array>

#include "drivers/icm42688/driver.hpp"
#include "firmware/boards/linux/bound_gyro.hpp"
#include "firmware/boards/linux/gyro_descriptions.hpp"

namespace zerorate::linux_node {
namespace {

namespace chip = drivers::icm42688;
using enum chip::OutputDataRate;
using enum chip::FullScale;

constexpr std::array kRatesHz{12.5, 25.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0};
constexpr std::array kRates{hz_12_5, hz_25, hz_50, hz_100, hz_200, hz_500, hz_1000, hz_2000};
constexpr std::array kFullScalesDps{15.625, 31.25, 62.5, 125.0, 250.0, 500.0, 1000.0, 2000.0};
constexpr std::array kFullScales{dps_15_625, dps_31_25, dps_62_5, dps_125,
                                 dps_250,    dps_500,   dps_1000, dps_2000};
constexpr std::array kAddresses{static_cast<std::uint8_t>(chip::kAddressAd0Low),
                                static_cast<std::uint8_t>(chip::kAddressAd0High)};

std::unique_ptr<drivers::AnyGyro> make(const GyroSettings& settings) {
  constexpr std::uint8_t kSpiMode = 3;
  return make_register_gyro<drivers::Icm42688>(
      settings, kSpiMode,
      chip::Settings{.full_scale = code_of(settings.full_scale_dps, kFullScalesDps, kFullScales),
                     .rate = code_of(settings.rate_hz, kRatesHz, kRates),
                     .mode = settings.fifo ? chip::Mode::fifo : chip::Mode::data_ready});
}

}  // namespace

ChipDescription describe_icm42688() {
  return {.name = "icm42688",
          .rates_hz = kRatesHz,
          .full_scales_dps = kFullScalesDps,
          .addresses = kAddresses,
          .highest_speed_hz = 24'000'000,
          .has_fifo = true,
          .counts = 32768.0,
          .make = make};
}

}  // namespace zerorate::linux_node

#include <array>

#include "drivers/bmi088/driver.hpp"
#include "firmware/boards/linux/bound_gyro.hpp"
#include "firmware/boards/linux/gyro_descriptions.hpp"

namespace zerorate::linux_node {
namespace {

namespace chip = drivers::bmi088;
using enum chip::OutputDataRate;
using enum chip::FullScale;

// Of each rate the wider filter: what it lets through is averaged by the node.
constexpr std::array kRatesHz{100.0, 200.0, 400.0, 1000.0, 2000.0};
constexpr std::array kRates{hz_100_bandwidth_32, hz_200_bandwidth_64, hz_400_bandwidth_47,
                            hz_1000_bandwidth_116, hz_2000_bandwidth_532};
constexpr std::array kFullScalesDps{125.0, 250.0, 500.0, 1000.0, 2000.0};
constexpr std::array kFullScales{dps_125, dps_250, dps_500, dps_1000, dps_2000};
constexpr std::array kAddresses{static_cast<std::uint8_t>(chip::kAddressSdo2Low),
                                static_cast<std::uint8_t>(chip::kAddressSdo2High)};

std::unique_ptr<drivers::AnyGyro> make(const GyroSettings& settings) {
  constexpr std::uint8_t kSpiMode = 3;
  return make_register_gyro<drivers::Bmi088>(
      settings, kSpiMode,
      chip::Settings{.full_scale = code_of(settings.full_scale_dps, kFullScalesDps, kFullScales),
                     .rate = code_of(settings.rate_hz, kRatesHz, kRates),
                     .mode = settings.fifo ? chip::Mode::fifo : chip::Mode::data_ready});
}

}  // namespace

ChipDescription describe_bmi088() {
  return {.name = "bmi088",
          .rates_hz = kRatesHz,
          .full_scales_dps = kFullScalesDps,
          .addresses = kAddresses,
          .highest_speed_hz = 10'000'000,
          .has_fifo = true,
          .counts = 32768.0,
          .make = make};
}

}  // namespace zerorate::linux_node

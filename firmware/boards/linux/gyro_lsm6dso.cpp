#include <array>

#include "drivers/lsm6dso/driver.hpp"
#include "firmware/boards/linux/bound_gyro.hpp"
#include "firmware/boards/linux/gyro_descriptions.hpp"

namespace zerorate::linux_node {
namespace {

namespace chip = drivers::lsm6dso;
using enum chip::OutputDataRate;
using enum chip::FullScale;

constexpr std::array kRatesHz{12.5, 26.0, 52.0, 104.0, 208.0, 416.0, 833.0, 1666.0, 3332.0, 6664.0};
constexpr std::array kRates{hz_12_5, hz_26,  hz_52,   hz_104,  hz_208,
                            hz_416,  hz_833, hz_1666, hz_3332, hz_6664};
constexpr std::array kFullScalesDps{125.0, 250.0, 500.0, 1000.0, 2000.0};
constexpr std::array kFullScales{dps_125, dps_250, dps_500, dps_1000, dps_2000};
constexpr std::array kAddresses{static_cast<std::uint8_t>(chip::kAddressSa0Low),
                                static_cast<std::uint8_t>(chip::kAddressSa0High)};

std::unique_ptr<drivers::AnyGyro> make(const GyroSettings& settings) {
  constexpr std::uint8_t kSpiMode = 3;
  return make_register_gyro<drivers::Lsm6dso>(
      settings, kSpiMode,
      chip::Settings{.full_scale = code_of(settings.full_scale_dps, kFullScalesDps, kFullScales),
                     .rate = code_of(settings.rate_hz, kRatesHz, kRates),
                     .mode = settings.fifo ? chip::Mode::fifo : chip::Mode::data_ready});
}

}  // namespace

ChipDescription describe_lsm6dso() {
  return {.name = "lsm6dso",
          .rates_hz = kRatesHz,
          .full_scales_dps = kFullScalesDps,
          .addresses = kAddresses,
          .highest_speed_hz = 10'000'000,
          .has_fifo = true,
          .counts = 1000.0 / 0.035,
          .make = make};
}

}  // namespace zerorate::linux_node

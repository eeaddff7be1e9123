/// @file
/// The gyro that this image is built for, chosen by pico_image() in CMakeLists.txt: its driver,
/// settings and model. A sample raises data-ready and is read within its period: no FIFO is needed.
#pragma once

#include <cstdint>
#include <string_view>

#if defined(ZERORATE_PICO_ICM42688)

#include "drivers/icm42688/driver.hpp"
#include "firmware/boards/pico/model_icm42688.hpp"
namespace zerorate::pico {
namespace chip = drivers::icm42688;
template <class Bus>
using Chip = drivers::Icm42688<Bus>;
inline constexpr std::string_view kChipName = "icm42688";
inline constexpr auto kI2cAddress = chip::kAddressAd0Low;
inline constexpr std::uint32_t kSpiHz = 8'000'000;
inline constexpr chip::Settings kGyroSettings{.full_scale = chip::FullScale::dps_250,
                                              .rate = chip::OutputDataRate::hz_100,
                                              .mode = chip::Mode::data_ready};
}  // namespace zerorate::pico

#elif defined(ZERORATE_PICO_BMI088)

#include "drivers/bmi088/driver.hpp"
#include "firmware/boards/pico/model_bmi088.hpp"
namespace zerorate::pico {
namespace chip = drivers::bmi088;
template <class Bus>
using Chip = drivers::Bmi088<Bus>;
inline constexpr std::string_view kChipName = "bmi088";
inline constexpr auto kI2cAddress = chip::kAddressSdo2Low;
inline constexpr std::uint32_t kSpiHz = 8'000'000;
inline constexpr chip::Settings kGyroSettings{.full_scale = chip::FullScale::dps_250,
                                              .rate = chip::OutputDataRate::hz_100_bandwidth_32,
                                              .mode = chip::Mode::data_ready};
}  // namespace zerorate::pico

#elif defined(ZERORATE_PICO_ADXRS453)

#include "drivers/adxrs453/driver.hpp"
#include "firmware/boards/pico/model_adxrs453.hpp"
namespace zerorate::pico {
namespace chip = drivers::adxrs453;
template <class Bus>
using Chip = drivers::Adxrs453<Bus>;
inline constexpr std::string_view kChipName = "adxrs453";
inline constexpr std::uint32_t kSpiHz = 8'000'000;
/// The chip has no data-ready line: it is asked as often as its bandwidth wants.
inline constexpr chip::Settings kGyroSettings{.sample_period = core::Duration::milliseconds(5)};
}  // namespace zerorate::pico

#else

#include "drivers/lsm6dso/driver.hpp"
#include "firmware/boards/pico/model.hpp"
namespace zerorate::pico {
namespace chip = drivers::lsm6dso;
template <class Bus>
using Chip = drivers::Lsm6dso<Bus>;
inline constexpr std::string_view kChipName = "lsm6dso";
inline constexpr auto kI2cAddress = chip::kAddressSa0Low;
inline constexpr std::uint32_t kSpiHz = 8'000'000;
inline constexpr chip::Settings kGyroSettings{.full_scale = chip::FullScale::dps_250,
                                              .rate = chip::OutputDataRate::hz_104,
                                              .mode = chip::Mode::data_ready};
}  // namespace zerorate::pico

#endif

namespace zerorate::pico {

/// How often the main loop turns even if no edge comes. A chip without a data-ready line is looked
/// at twice a sample.
inline constexpr std::uint32_t kBeat_us = kChipName == "adxrs453" ? 2'500 : 10'000;

/// Rate of the serial line: a message takes 740 bits, and at most half of the line shall be used.
inline constexpr std::uint32_t kBaud =
    exported::kNodeParams.sample_period < core::Duration::milliseconds(8) ? 460'800 : 115'200;

}  // namespace zerorate::pico

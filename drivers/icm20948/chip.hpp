/// @file
/// The ICM-20948 in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/icm20948/codec.hpp"
#include "drivers/icm20948/configuration.hpp"
#include "drivers/icm20948/driver.hpp"
#include "drivers/icm20948/registers.hpp"

namespace zerorate::drivers::icm20948 {

/// See drivers::ChipEntry.
struct Chip {
  static constexpr std::string_view kName = "icm20948";
  template <RegisterBus Bus>
  using Driver = Icm20948<Bus>;
  template <RegisterBus Bus>
  using DriverWithAcceleration = Icm20948<Bus, Accelerometer::on>;
  using Settings = icm20948::Settings;
  static constexpr std::size_t kAxes = 3;
  static constexpr auto kRates =
      std::to_array<Choice<OutputDataRate>>({{12.5, OutputDataRate::hz_12_5},
                                             {25.0, OutputDataRate::hz_25},
                                             {45.0, OutputDataRate::hz_45},
                                             {75.0, OutputDataRate::hz_75},
                                             {125.0, OutputDataRate::hz_125},
                                             {225.0, OutputDataRate::hz_225},
                                             {562.5, OutputDataRate::hz_562_5},
                                             {1125.0, OutputDataRate::hz_1125}});
  static constexpr auto kFullScales =
      std::to_array<Choice<FullScale>>({{250.0, FullScale::dps_250},
                                        {500.0, FullScale::dps_500},
                                        {1000.0, FullScale::dps_1000},
                                        {2000.0, FullScale::dps_2000}});
  static constexpr auto kAccelerationRanges =
      std::to_array<Choice<AccelerationRange>>({{2.0, AccelerationRange::g_2},
                                                {4.0, AccelerationRange::g_4},
                                                {8.0, AccelerationRange::g_8},
                                                {16.0, AccelerationRange::g_16}});
  static constexpr double kUsualAccelerationRange_g = 4.0;
  static constexpr double kCounts = 32768.0;
  static constexpr bool kHasDataReady = true;
  static constexpr bool kHasFifo = true;
  static constexpr bool kHasThermometer = true;
  static constexpr std::array kAddresses{kAddressAd0Low, kAddressAd0High};
  static constexpr auto kIdentity = kWhoAmI;
  static constexpr std::uint8_t kSpiMode = 3;
  static constexpr std::uint32_t kHighestSpi_hz = 7'000'000;

  static constexpr Settings settings(OutputDataRate rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};
static_assert(RegisterChipEntry<Chip>);
static_assert(AccelerometerChipEntry<Chip>);

using Chips = core::TypeList<Chip>;

}  // namespace zerorate::drivers::icm20948

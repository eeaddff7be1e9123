/// @file
/// The ICM-45686 in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/icm45686/codec.hpp"
#include "drivers/icm45686/configuration.hpp"
#include "drivers/icm45686/driver.hpp"
#include "drivers/icm45686/registers.hpp"

namespace zerorate::drivers::icm45686 {

/// See drivers::ChipEntry.
struct Chip {
  static constexpr std::string_view kName = "icm45686";
  template <BurstBus Bus>
  using Driver = Icm45686<Bus>;
  template <BurstBus Bus>
  using DriverWithAcceleration = Icm45686<Bus, Accelerometer::on>;
  using Settings = icm45686::Settings;
  static constexpr std::size_t kAxes = 3;
  static constexpr auto kRates =
      std::to_array<Choice<OutputDataRate>>({{12.5, OutputDataRate::hz_12_5},
                                             {25.0, OutputDataRate::hz_25},
                                             {50.0, OutputDataRate::hz_50},
                                             {100.0, OutputDataRate::hz_100},
                                             {200.0, OutputDataRate::hz_200},
                                             {400.0, OutputDataRate::hz_400},
                                             {800.0, OutputDataRate::hz_800},
                                             {1600.0, OutputDataRate::hz_1600}});
  static constexpr auto kFullScales =
      std::to_array<Choice<FullScale>>({{15.625, FullScale::dps_15_625},
                                        {31.25, FullScale::dps_31_25},
                                        {62.5, FullScale::dps_62_5},
                                        {125.0, FullScale::dps_125},
                                        {250.0, FullScale::dps_250},
                                        {500.0, FullScale::dps_500},
                                        {1000.0, FullScale::dps_1000},
                                        {2000.0, FullScale::dps_2000},
                                        {4000.0, FullScale::dps_4000}});
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
  static constexpr std::uint32_t kHighestSpi_hz = 24'000'000;

  static constexpr Settings settings(OutputDataRate rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};
static_assert(RegisterChipEntry<Chip>);
static_assert(AccelerometerChipEntry<Chip>);

using Chips = core::TypeList<Chip>;

}  // namespace zerorate::drivers::icm45686

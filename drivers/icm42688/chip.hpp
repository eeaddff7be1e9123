/// @file
/// The ICM-42688-P and its relatives in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/icm42688/codec.hpp"
#include "drivers/icm42688/driver.hpp"
#include "drivers/icm42688/registers.hpp"

namespace zerorate::drivers::icm42688 {

/// See drivers::ChipEntry. What all of them have in common.
template <Part kPart>
struct ChipOf {
  template <RegisterBus Bus>
  using Driver = Icm42688<Bus>;
  template <RegisterBus Bus>
  using DriverWithAcceleration = Icm42688<Bus, Accelerometer::on>;
  using Settings = SettingsOf<kPart>;
  static constexpr std::size_t kAxes = 3;
  static constexpr auto kRates =
      std::to_array<Choice<OutputDataRate>>({{12.5, OutputDataRate::hz_12_5},
                                             {25.0, OutputDataRate::hz_25},
                                             {50.0, OutputDataRate::hz_50},
                                             {100.0, OutputDataRate::hz_100},
                                             {200.0, OutputDataRate::hz_200},
                                             {500.0, OutputDataRate::hz_500},
                                             {1000.0, OutputDataRate::hz_1000},
                                             {2000.0, OutputDataRate::hz_2000}});
  static constexpr auto kFullScales =
      std::to_array<Choice<FullScale>>({{15.625, FullScale::dps_15_625},
                                        {31.25, FullScale::dps_31_25},
                                        {62.5, FullScale::dps_62_5},
                                        {125.0, FullScale::dps_125},
                                        {250.0, FullScale::dps_250},
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
  static constexpr Register<kWhoAmI.address, Access::read_only, static_cast<std::uint8_t>(kPart)>
      kIdentity{};
  static constexpr std::uint8_t kSpiMode = 3;
  static constexpr std::uint32_t kHighestSpi_hz = 24'000'000;

  static constexpr Settings settings(OutputDataRate rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};

struct Chip : ChipOf<Part::icm42688> {
  static constexpr std::string_view kName = "icm42688";
};
struct Icm42605 : ChipOf<Part::icm42605> {
  static constexpr std::string_view kName = "icm42605";
};
struct Iim42652 : ChipOf<Part::iim42652> {
  static constexpr std::string_view kName = "iim42652";
};
static_assert(RegisterChipEntry<Chip>);
static_assert(AccelerometerChipEntry<Chip>);

using Chips = core::TypeList<Chip, Icm42605, Iim42652>;

}  // namespace zerorate::drivers::icm42688

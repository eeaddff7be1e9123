/// @file
/// The MPU-6500 and its relatives in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/common/acceleration.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/mpu6500/codec.hpp"
#include "drivers/mpu6500/driver.hpp"
#include "drivers/mpu6500/registers.hpp"

namespace zerorate::drivers::mpu6500 {

/// See drivers::ChipEntry.
struct Chip {
  static constexpr std::string_view kName = "mpu6500";
  template <RegisterBus Bus>
  using Driver = Mpu6500<Bus>;
  template <RegisterBus Bus>
  using DriverWithAcceleration = Mpu6500<Bus, Accelerometer::on>;
  using Settings = mpu6500::Settings;
  static constexpr std::size_t kAxes = 3;
  static constexpr auto kRates =
      std::to_array<Choice<OutputDataRate>>({{12.5, OutputDataRate::hz_12_5},
                                             {25.0, OutputDataRate::hz_25},
                                             {50.0, OutputDataRate::hz_50},
                                             {100.0, OutputDataRate::hz_100},
                                             {125.0, OutputDataRate::hz_125},
                                             {200.0, OutputDataRate::hz_200},
                                             {250.0, OutputDataRate::hz_250},
                                             {500.0, OutputDataRate::hz_500},
                                             {1000.0, OutputDataRate::hz_1000}});
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
  static constexpr std::uint32_t kHighestSpi_hz = 1'000'000;

  static constexpr bool is_identity(std::uint8_t answer) { return find_variant(answer) != nullptr; }
  static constexpr Settings settings(OutputDataRate rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};
static_assert(RegisterChipEntry<Chip>);
static_assert(AccelerometerChipEntry<Chip>);

}  // namespace zerorate::drivers::mpu6500

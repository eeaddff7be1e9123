/// @file
/// The BMI270 in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "drivers/bmi270/codec.hpp"
#include "drivers/bmi270/driver.hpp"
#include "drivers/bmi270/registers.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/common/register_access.hpp"
#include "hal/contract/spi_device.hpp"

namespace zerorate::drivers::bmi270 {

/// See drivers::ChipEntry.
struct Chip {
  static constexpr std::string_view kName = "bmi270";
  template <BurstBus Bus>
  using Driver = Bmi270<Bus>;
  template <BurstBus Bus>
  using DriverWithAcceleration = Bmi270<Bus, Accelerometer::on>;
  template <hal::SpiDevice Device>
  using Spi = SpiRegistersWithDummy<Device>;
  using Settings = bmi270::Settings;
  static constexpr std::size_t kAxes = 3;
  static constexpr auto kRates =
      std::to_array<Choice<OutputDataRate>>({{25.0, OutputDataRate::hz_25},
                                             {50.0, OutputDataRate::hz_50},
                                             {100.0, OutputDataRate::hz_100},
                                             {200.0, OutputDataRate::hz_200},
                                             {400.0, OutputDataRate::hz_400},
                                             {800.0, OutputDataRate::hz_800},
                                             {1600.0, OutputDataRate::hz_1600}});
  static constexpr auto kFullScales =
      std::to_array<Choice<FullScale>>({{125.0, FullScale::dps_125},
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
  static constexpr std::array kAddresses{kAddressSdoLow, kAddressSdoHigh};
  static constexpr auto kIdentity = kChipId;
  static constexpr std::uint8_t kSpiMode = 3;
  static constexpr std::uint32_t kHighestSpi_hz = 10'000'000;

  static constexpr bool takes_config_file(std::size_t bytes) { return is_config_file_size(bytes); }
  static constexpr Settings settings(OutputDataRate rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};
static_assert(RegisterChipEntry<Chip>);
static_assert(AccelerometerChipEntry<Chip>);
static_assert(ConfigFileChipEntry<Chip>);

using Chips = core::TypeList<Chip>;

}  // namespace zerorate::drivers::bmi270

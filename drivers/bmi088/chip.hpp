/// @file
/// The BMI088 in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "drivers/bmi088/accelerometer.hpp"
#include "drivers/bmi088/codec.hpp"
#include "drivers/bmi088/driver.hpp"
#include "drivers/bmi088/registers.hpp"
#include "drivers/common/chip.hpp"

namespace zerorate::drivers::bmi088 {

/// See drivers::ChipEntry.
struct Chip {
  static constexpr std::string_view kName = "bmi088";
  template <RegisterBus Bus>
  using Driver = Bmi088<Bus>;
  /// @tparam Buses  of both dies: bmi088::Buses
  template <class Buses>
  using DriverWithAcceleration = Bmi088<typename Buses::Gyro, typename Buses::Accelerometer>;
  using Settings = bmi088::Settings;
  static constexpr std::size_t kAxes = 3;
  // The wider filter of each rate: the node averages what it lets through.
  static constexpr auto kRates =
      std::to_array<Choice<OutputDataRate>>({{100.0, OutputDataRate::hz_100_bandwidth_32},
                                             {200.0, OutputDataRate::hz_200_bandwidth_64},
                                             {400.0, OutputDataRate::hz_400_bandwidth_47},
                                             {1000.0, OutputDataRate::hz_1000_bandwidth_116},
                                             {2000.0, OutputDataRate::hz_2000_bandwidth_532}});
  static constexpr auto kFullScales =
      std::to_array<Choice<FullScale>>({{125.0, FullScale::dps_125},
                                        {250.0, FullScale::dps_250},
                                        {500.0, FullScale::dps_500},
                                        {1000.0, FullScale::dps_1000},
                                        {2000.0, FullScale::dps_2000}});
  template <class Device>
  using AccelerometerSpi = bmi088::AccelerometerSpi<Device>;
  template <class GyroBus, class AccelerometerBus>
  static constexpr Buses<GyroBus, AccelerometerBus> buses(GyroBus gyro,
                                                          AccelerometerBus accelerometer) {
    return {gyro, accelerometer};
  }
  static constexpr auto kAccelerationRanges =
      std::to_array<Choice<AccelerationRange>>({{3.0, AccelerationRange::g_3},
                                                {6.0, AccelerationRange::g_6},
                                                {12.0, AccelerationRange::g_12},
                                                {24.0, AccelerationRange::g_24}});
  static constexpr double kUsualAccelerationRange_g = 6.0;
  static constexpr std::array kAccelerometerAddresses{kAccAddressSdo1Low, kAccAddressSdo1High};
  static constexpr double kCounts = 32768.0;
  static constexpr bool kHasDataReady = true;
  static constexpr bool kHasFifo = true;
  static constexpr bool kHasThermometer = false;
  static constexpr std::array kAddresses{kAddressSdo2Low, kAddressSdo2High};
  static constexpr auto kIdentity = kGyroChipId;
  static constexpr std::uint8_t kSpiMode = 3;
  static constexpr std::uint32_t kHighestSpi_hz = 10'000'000;

  static constexpr Settings settings(OutputDataRate rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};
static_assert(RegisterChipEntry<Chip>);
static_assert(TwoDieChipEntry<Chip>);

using Chips = core::TypeList<Chip>;

}  // namespace zerorate::drivers::bmi088

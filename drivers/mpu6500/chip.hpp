/// @file
/// The MPU-6500 and its relatives in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/mpu6500/codec.hpp"
#include "drivers/mpu6500/driver.hpp"
#include "drivers/mpu6500/registers.hpp"

namespace zerorate::drivers::mpu6500 {

/// See drivers::ChipEntry. What all of them have in common.
template <Part kPart>
struct ChipOf {
  template <RegisterBus Bus>
  using Driver = Mpu6500<Bus>;
  template <RegisterBus Bus>
  using DriverWithAcceleration = Mpu6500<Bus, Accelerometer::on>;
  using Settings = SettingsOf<kPart>;
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
  static constexpr Register<kWhoAmI.address, Access::read_only, static_cast<std::uint8_t>(kPart)>
      kIdentity{};
  static constexpr std::uint8_t kSpiMode = 3;
  static constexpr std::uint32_t kHighestSpi_hz =
      variant_of(kPart).is_younger ? 10'000'000 : (kPart == Part::icm20689 ? 8'000'000 : 1'000'000);

  static constexpr bool is_identity(std::uint8_t answer) { return takes(kPart, answer); }
  static constexpr Settings settings(OutputDataRate rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};

struct Chip : ChipOf<Part::mpu6500> {
  static constexpr std::string_view kName = "mpu6500";
};
struct Icm20602 : ChipOf<Part::icm20602> {
  static constexpr std::string_view kName = "icm20602";
};
struct Mpu6886 : ChipOf<Part::mpu6886> {
  static constexpr std::string_view kName = "mpu6886";
};
struct Icm20689 : ChipOf<Part::icm20689> {
  static constexpr std::string_view kName = "icm20689";
};
static_assert(RegisterChipEntry<Chip>);
static_assert(AccelerometerChipEntry<Chip>);

using Chips = core::TypeList<Chip, Icm20602, Mpu6886, Icm20689>;

}  // namespace zerorate::drivers::mpu6500

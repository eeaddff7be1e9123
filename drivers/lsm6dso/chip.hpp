/// @file
/// The LSM6DSO and its relatives in the table of chips.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/lsm6dso/codec.hpp"
#include "drivers/lsm6dso/driver.hpp"
#include "drivers/lsm6dso/registers.hpp"

namespace zerorate::drivers::lsm6dso {

/// Rates of a chip by their names in its data sheet.
template <Part kPart>
inline constexpr auto kRates =
    std::to_array<Choice<OutputDataRate>>({{12.5, OutputDataRate::hz_12_5},
                                           {26.0, OutputDataRate::hz_26},
                                           {52.0, OutputDataRate::hz_52},
                                           {104.0, OutputDataRate::hz_104},
                                           {208.0, OutputDataRate::hz_208},
                                           {416.0, OutputDataRate::hz_416},
                                           {833.0, OutputDataRate::hz_833},
                                           {1666.0, OutputDataRate::hz_1666},
                                           {3332.0, OutputDataRate::hz_3332},
                                           {6664.0, OutputDataRate::hz_6664}});
template <>
inline constexpr auto kRates<Part::lsm6dsv16x> =
    std::to_array<Choice<DsvRate>>({{7.5, DsvRate::hz_7_5},
                                    {15.0, DsvRate::hz_15},
                                    {30.0, DsvRate::hz_30},
                                    {60.0, DsvRate::hz_60},
                                    {120.0, DsvRate::hz_120},
                                    {240.0, DsvRate::hz_240},
                                    {480.0, DsvRate::hz_480},
                                    {960.0, DsvRate::hz_960},
                                    {1920.0, DsvRate::hz_1920},
                                    {3840.0, DsvRate::hz_3840},
                                    {7680.0, DsvRate::hz_7680}});

/// See drivers::ChipEntry. What all of them have in common.
template <Part kPart>
struct ChipOf {
  template <RegisterBus Bus>
  using Driver = Lsm6dso<Bus>;
  template <RegisterBus Bus>
  using DriverWithAcceleration = Lsm6dso<Bus, Accelerometer::on>;
  using Settings = SettingsOf<kPart>;
  static constexpr std::size_t kAxes = 3;
  static constexpr auto kRates = lsm6dso::kRates<kPart>;
  static constexpr auto kFullScales = [] {
    constexpr std::size_t kCount = variant(kPart).has_4000_dps ? 6 : 5;
    constexpr auto kAll = std::to_array<Choice<FullScale>>({{125.0, FullScale::dps_125},
                                                            {250.0, FullScale::dps_250},
                                                            {500.0, FullScale::dps_500},
                                                            {1000.0, FullScale::dps_1000},
                                                            {2000.0, FullScale::dps_2000},
                                                            {4000.0, FullScale::dps_4000}});
    std::array<Choice<FullScale>, kCount> choices{};
    std::copy_n(kAll.begin(), kCount, choices.begin());
    return choices;
  }();
  static constexpr auto kAccelerationRanges =
      std::to_array<Choice<AccelerationRange>>({{2.0, AccelerationRange::g_2},
                                                {4.0, AccelerationRange::g_4},
                                                {8.0, AccelerationRange::g_8},
                                                {16.0, AccelerationRange::g_16}});
  static constexpr double kUsualAccelerationRange_g = 4.0;
  static constexpr double kCounts = 1000.0 / 0.035;
  static constexpr bool kHasDataReady = true;
  static constexpr bool kHasFifo = variant(kPart).has_tags;
  static constexpr bool kHasThermometer = true;
  static constexpr std::array kAddresses{kAddressSa0Low, kAddressSa0High};
  static constexpr Register<kWhoAmI.address, Access::read_only, variant(kPart).identity>
      kIdentity{};
  static constexpr std::uint8_t kSpiMode = 3;
  static constexpr std::uint32_t kHighestSpi_hz = 10'000'000;

  static constexpr Settings settings(RateOf<kPart> rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};

struct Chip : ChipOf<Part::lsm6dso> {
  static constexpr std::string_view kName = "lsm6dso";
};
struct Ism330dhcx : ChipOf<Part::ism330dhcx> {
  static constexpr std::string_view kName = "ism330dhcx";
};
struct Asm330lhh : ChipOf<Part::asm330lhh> {
  static constexpr std::string_view kName = "asm330lhh";
};
struct Lsm6dsv16x : ChipOf<Part::lsm6dsv16x> {
  static constexpr std::string_view kName = "lsm6dsv16x";
};
struct Lsm6dsr : ChipOf<Part::lsm6dsr> {
  static constexpr std::string_view kName = "lsm6dsr";
};
struct Lsm6dsox : ChipOf<Part::lsm6dsox> {
  static constexpr std::string_view kName = "lsm6dsox";
};
struct Lsm6dsl : ChipOf<Part::lsm6dsl> {
  static constexpr std::string_view kName = "lsm6dsl";
};
struct Lsm6ds3trC : ChipOf<Part::lsm6ds3tr_c> {
  static constexpr std::string_view kName = "lsm6ds3tr-c";
};
static_assert(RegisterChipEntry<Chip>);
static_assert(RegisterChipEntry<Lsm6dsv16x>);
static_assert(AccelerometerChipEntry<Chip>);

using Chips =
    core::TypeList<Chip, Ism330dhcx, Asm330lhh, Lsm6dsv16x, Lsm6dsr, Lsm6dsox, Lsm6dsl, Lsm6ds3trC>;

}  // namespace zerorate::drivers::lsm6dso

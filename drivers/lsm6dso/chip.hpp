/// @file
/// The LSM6DSO in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "drivers/common/chip.hpp"
#include "drivers/lsm6dso/codec.hpp"
#include "drivers/lsm6dso/driver.hpp"
#include "drivers/lsm6dso/registers.hpp"

namespace zerorate::drivers::lsm6dso {

/// See drivers::ChipEntry.
struct Chip {
  static constexpr std::string_view kName = "lsm6dso";
  template <RegisterBus Bus>
  using Driver = Lsm6dso<Bus>;
  using Settings = lsm6dso::Settings;
  static constexpr std::size_t kAxes = 3;
  static constexpr auto kRates =
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
  static constexpr auto kFullScales =
      std::to_array<Choice<FullScale>>({{125.0, FullScale::dps_125},
                                        {250.0, FullScale::dps_250},
                                        {500.0, FullScale::dps_500},
                                        {1000.0, FullScale::dps_1000},
                                        {2000.0, FullScale::dps_2000}});
  static constexpr double kCounts = 1000.0 / 0.035;
  static constexpr bool kHasDataReady = true;
  static constexpr bool kHasFifo = true;
  static constexpr std::array kAddresses{kAddressSa0Low, kAddressSa0High};
  static constexpr auto kIdentity = kWhoAmI;
  static constexpr std::uint8_t kSpiMode = 3;
  static constexpr std::uint32_t kHighestSpi_hz = 10'000'000;

  static constexpr Settings settings(OutputDataRate rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};
static_assert(RegisterChipEntry<Chip>);

}  // namespace zerorate::drivers::lsm6dso

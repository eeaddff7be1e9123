/// @file
/// The L3GD20H and its relatives in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/l3gd20h/codec.hpp"
#include "drivers/l3gd20h/driver.hpp"
#include "drivers/l3gd20h/registers.hpp"

namespace zerorate::drivers::l3gd20h {

/// See drivers::ChipEntry. What all of them have in common.
template <Part kPart>
struct ChipOf {
  template <RegisterBus Bus>
  using Driver = L3gd20h<Bus>;
  using Settings = SettingsOf<kPart>;
  static constexpr std::size_t kAxes = 3;
  static constexpr auto kRates = [] {
    constexpr double kLowest_hz = variant(kPart).lowest_hz;
    return std::to_array<Choice<OutputDataRate>>({{kLowest_hz, OutputDataRate::times_1},
                                                  {2.0 * kLowest_hz, OutputDataRate::times_2},
                                                  {4.0 * kLowest_hz, OutputDataRate::times_4},
                                                  {8.0 * kLowest_hz, OutputDataRate::times_8}});
  }();
  static constexpr auto kFullScales = std::to_array<Choice<FullScale>>(
      {{250.0, FullScale::dps_250}, {500.0, FullScale::dps_500}, {2000.0, FullScale::dps_2000}});
  static constexpr double kCounts = 1000.0 / 0.035;
  static constexpr bool kHasDataReady = true;
  static constexpr bool kHasFifo = true;
  static constexpr bool kHasThermometer = false;
  static constexpr std::array kAddresses = kPart == Part::l3g4200d
                                               ? std::array{kOldAddressSa0Low, kOldAddressSa0High}
                                               : std::array{kAddressSa0Low, kAddressSa0High};
  static constexpr Register<kWhoAmI.address, Access::read_only, variant(kPart).identity>
      kIdentity{};
  static constexpr std::uint8_t kSpiMode = 3;
  static constexpr std::uint32_t kHighestSpi_hz = 10'000'000;

  static constexpr Settings settings(OutputDataRate rate, FullScale full_scale, bool is_fifo) {
    return {
        .full_scale = full_scale, .rate = rate, .mode = is_fifo ? Mode::fifo : Mode::data_ready};
  }
};

struct Chip : ChipOf<Part::l3gd20h> {
  static constexpr std::string_view kName = "l3gd20h";
};
struct L3gd20 : ChipOf<Part::l3gd20> {
  static constexpr std::string_view kName = "l3gd20";
};
struct L3g4200d : ChipOf<Part::l3g4200d> {
  static constexpr std::string_view kName = "l3g4200d";
};
static_assert(RegisterChipEntry<Chip>);

using Chips = core::TypeList<Chip, L3gd20, L3g4200d>;

}  // namespace zerorate::drivers::l3gd20h

/// @file
/// The ADXRS453 in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "core/base/time.hpp"
#include "drivers/adxrs453/codec.hpp"
#include "drivers/adxrs453/driver.hpp"
#include "drivers/adxrs453/registers.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/common/frame_bus.hpp"

namespace zerorate::drivers::adxrs453 {

/// See drivers::ChipEntry.
struct Chip {
  static constexpr std::string_view kName = "adxrs453";
  template <FrameBus Bus>
  using Driver = Adxrs453<Bus>;
  template <hal::SpiDevice Device>
  using Spi = SpiFrames<Device>;
  using Settings = adxrs453::Settings;
  static constexpr std::size_t kAxes = 1;
  // The chip converts all the time: the rate is how often it is asked. Below 155 Hz, noise of its
  // bandwidth of 77.5 Hz would fold.
  static constexpr auto kRates =
      std::to_array<Choice<core::Duration>>({{200.0, core::Duration::milliseconds(5)},
                                             {250.0, core::Duration::milliseconds(4)},
                                             {500.0, core::Duration::milliseconds(2)},
                                             {1000.0, core::Duration::milliseconds(1)}});
  static constexpr auto kFullScales = std::to_array<Choice<Fixed>>({{300.0, {}}});
  static constexpr double kCounts = 300.0 * 80.0;
  static constexpr bool kHasDataReady = false;
  static constexpr bool kHasFifo = false;
  static constexpr bool kHasThermometer = true;
  static constexpr std::uint8_t kSpiMode = 0;
  static constexpr std::uint32_t kHighestSpi_hz = 8'080'000;

  static constexpr Settings settings(core::Duration sample_period, Fixed /*full_scale*/,
                                     bool /*is_fifo*/) {
    return {.sample_period = sample_period};
  }

  static constexpr std::uint32_t kAskIdentity = encode_read(kPid1);
  static_assert(kAskIdentity >> 31U == 1, "chips with registers take the frame for a read too");
  static constexpr bool is_identity(std::uint32_t reply) {
    return has_good_parity(reply) && is_read_reply(reply) &&
           decode_read_data(reply) >> 8U == kPartId;
  }
};
static_assert(FrameChipEntry<Chip>);

using Chips = core::TypeList<Chip>;

}  // namespace zerorate::drivers::adxrs453

/// @file
/// The ADIS16470 and the ADIS16475 in the table of chips.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/compile_time.hpp"
#include "core/base/time.hpp"
#include "drivers/adis16475/codec.hpp"
#include "drivers/adis16475/driver.hpp"
#include "drivers/adis16475/registers.hpp"
#include "drivers/common/acceleration.hpp"
#include "drivers/common/chip.hpp"
#include "drivers/common/word_bus.hpp"

namespace zerorate::drivers::adis16475 {

/// See drivers::ChipEntry. What all of them have in common.
template <Part kPart>
struct ChipOf {
  template <WordBus Bus>
  using Driver = Adis16475<Bus>;
  template <WordBus Bus>
  using DriverWithAcceleration = Adis16475<Bus, Accelerometer::on>;
  template <hal::SpiDevice Device>
  using Spi = SpiWords<Device>;
  using Settings = SettingsOf<kPart>;
  static constexpr std::size_t kAxes = 3;
  // Below 100 Hz the noise of an average is too small beside the LSB of 0.1 deg/s (README).
  static constexpr auto kRates =
      std::to_array<Choice<OutputDataRate>>({{100.0, OutputDataRate::hz_100},
                                             {125.0, OutputDataRate::hz_125},
                                             {200.0, OutputDataRate::hz_200},
                                             {250.0, OutputDataRate::hz_250},
                                             {400.0, OutputDataRate::hz_400},
                                             {500.0, OutputDataRate::hz_500},
                                             {1000.0, OutputDataRate::hz_1000},
                                             {2000.0, OutputDataRate::hz_2000}});
  static constexpr auto kFullScales =
      std::to_array<Choice<Fixed>>({{double{variant(kPart).full_scale_dps}, {}}});
  static constexpr auto kAccelerationRanges =
      std::to_array<Choice<Fixed>>({{double{variant(kPart).range_g}, {}}});
  static constexpr double kUsualAccelerationRange_g = double{variant(kPart).range_g};
  static constexpr double kCounts = double{kFullScaleRaw};
  static constexpr bool kHasDataReady = true;
  static constexpr bool kHasFifo = false;
  static constexpr bool kHasThermometer = true;
  static constexpr std::uint8_t kSpiMode = 3;
  static constexpr std::uint32_t kHighestSpi_hz = 1'000'000;  // the clock of a burst
  static constexpr core::Duration kSpiPause = core::Duration::microseconds(16);

  static constexpr Settings settings(OutputDataRate rate, Fixed /*full_scale*/, bool /*is_fifo*/) {
    return {.rate = rate};
  }

  static constexpr std::uint16_t kAskIdentity = encode_read(kProdId);
  static constexpr bool is_identity(std::uint16_t reply) { return reply == variant(kPart).product; }
};

struct Chip : ChipOf<Part::adis16470> {
  static constexpr std::string_view kName = "adis16470";
};
struct Adis16475Part1 : ChipOf<Part::adis16475_1> {
  static constexpr std::string_view kName = "adis16475-1";
};
struct Adis16475Part2 : ChipOf<Part::adis16475_2> {
  static constexpr std::string_view kName = "adis16475-2";
};
struct Adis16475Part3 : ChipOf<Part::adis16475_3> {
  static constexpr std::string_view kName = "adis16475-3";
};
static_assert(WordChipEntry<Chip>);
static_assert(AccelerometerChipEntry<Chip>);

using Chips = core::TypeList<Chip, Adis16475Part1, Adis16475Part2, Adis16475Part3>;

}  // namespace zerorate::drivers::adis16475

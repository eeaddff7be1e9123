/// @file
/// Analog Devices' gyros, as simulated_gyros.hpp describes the others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "drivers/chips/chips.hpp"
#include "drivers/common/frame_bus.hpp"
#include "drivers/common/word_bus.hpp"
#include "hal/sim/chips.hpp"
#include "host_tests/support/gyro_description.hpp"

namespace zerorate::support {

/// Analog Devices' inertial units, whose parts differ in their ranges.
template <class SimulatedChip, class Line>
struct AdisFamily {
  using Simulated = SimulatedChip;
  using Settings = typename Line::Settings;
  template <class Bus>
  using Driver = drivers::Adis16475<Bus>;
  template <class Device>
  using Spi = drivers::SpiWords<Device>;

  static constexpr Settings kDataReady{};
  static constexpr Settings kFifo{.rate = drivers::adis16475::OutputDataRate::hz_200};  // none
  static constexpr std::int16_t kLowestRaw = -32768;
  static constexpr float kTemperatureLsb = 0.1F;
  static constexpr bool kFramesAreMarked = true;
  static constexpr std::size_t kReadTransactions = 1;
  static constexpr std::size_t kVerifyTransactions = 2;
  static constexpr bool kIsSampledByReading = false;
  /// The pin is active while the outputs are valid, read or not.
  static constexpr bool kReadingReleasesPin = false;

  static constexpr std::uint8_t kIdentity = 0x72;
  static constexpr std::array kConfigured{ConfiguredBits{0x5C, 0x07}, ConfiguredBits{0x60, 0xDF},
                                          ConfiguredBits{0x61, 0x03}, ConfiguredBits{0x64, 0xFF},
                                          ConfiguredBits{0x65, 0x07}};
  /// 310 ms after power-on and after a reset, and one more.
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(621);
  /// 5 ms and three samples of 200 or 100 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(20);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(45);
};
struct Adis16470 : AdisFamily<hal::sim::SimulatedAdis16470, drivers::adis16475::Chip> {
  static constexpr const char* kName = "Adis16470";
  static constexpr std::array kRanges{Range<Settings>{{}, 0.1F, 1999.0F}};
  static constexpr float kLsbDps = 0.1F;
  static constexpr float kFullScaleDps = 2000.0F;
};
struct Adis16475Part1
    : AdisFamily<hal::sim::SimulatedAdis16475Part1, drivers::adis16475::Adis16475Part1> {
  static constexpr const char* kName = "Adis16475Part1";
  static constexpr std::array kRanges{Range<Settings>{{}, 0.00625F, 124.9F}};
  static constexpr float kLsbDps = 0.00625F;
  static constexpr float kFullScaleDps = 125.0F;
};
struct Adis16475Part2
    : AdisFamily<hal::sim::SimulatedAdis16475Part2, drivers::adis16475::Adis16475Part2> {
  static constexpr const char* kName = "Adis16475Part2";
  static constexpr std::array kRanges{Range<Settings>{{}, 0.025F, 499.9F}};
  static constexpr float kLsbDps = 0.025F;
  static constexpr float kFullScaleDps = 500.0F;
};

struct Adxrs453 {
  static constexpr const char* kName = "Adxrs453";
  using Simulated = hal::sim::SimulatedAdxrs453;
  using Settings = drivers::adxrs453::Settings;
  template <class Bus>
  using Driver = drivers::Adxrs453<Bus>;
  template <class Device>
  using Spi = drivers::SpiFrames<Device>;

  static constexpr Settings kDataReady{};
  static constexpr Settings kFifo{.sample_period = core::Duration::milliseconds(10)};  // none
  static constexpr std::array kRanges{Range<Settings>{{}, 1.0F / 80.0F, 299.0F}};
  static constexpr float kLsbDps = 1.0F / 80.0F;
  static constexpr float kFullScaleDps = 300.0F;
  static constexpr std::int16_t kLowestRaw = -32000;
  static constexpr float kTemperatureLsb = 0.2F;
  static constexpr bool kFramesAreMarked = true;
  static constexpr std::size_t kVerifyTransactions = 2;
  static constexpr bool kIsSampledByReading = true;

  static constexpr std::uint8_t kIdentity = 0x0C;
  /// Nothing is configured; these are the serial number, which stands for the chip itself, and the
  /// faults.
  static constexpr std::array kConfigured{ConfiguredBits{0x0E, 0xFF}, ConfiguredBits{0x0F, 0xFF},
                                          ConfiguredBits{0x10, 0xFF}, ConfiguredBits{0x11, 0xFF},
                                          ConfiguredBits{0x0A, 0x0F}, ConfiguredBits{0x0B, 0xFE}};
  /// 100 ms after power-on, and three times 50 ms.
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(250);
  static constexpr core::Duration kEarliest{};
  static constexpr core::Duration kLatest = core::Duration::milliseconds(10);
};

}  // namespace zerorate::support

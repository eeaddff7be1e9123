/// @file
/// ST's gyros, as the contract suite sees them (simulated_gyros.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/time.hpp"
#include "drivers/chips/chips.hpp"
#include "hal/sim/chips.hpp"
#include "host_tests/support/gyro_description.hpp"

namespace zerorate::support {

/// ST's family. `SettingsOfChip` says which of them the driver is for.
template <class SimulatedChip, class SettingsOfChip, bool kHas4000Dps>
struct Lsm6Family {
  using Simulated = SimulatedChip;
  using Settings = SettingsOfChip;
  using FullScale = drivers::lsm6dso::FullScale;
  template <class Bus>
  using Driver = drivers::Lsm6dso<Bus>;
  static constexpr hal::I2cAddress kAddress{0x6A};

  static constexpr Settings kDataReady{.mode = drivers::lsm6dso::Mode::data_ready};
  static constexpr Settings kFifo{.mode = drivers::lsm6dso::Mode::fifo, .fifo_watermark = 3};
  static constexpr auto kRanges = [] {
    constexpr std::array kAll{
        Range<Settings>{{.full_scale = FullScale::dps_125}, 4.375e-3F, 124.0F},
        Range<Settings>{{.full_scale = FullScale::dps_250}, 8.75e-3F, 249.0F},
        Range<Settings>{{.full_scale = FullScale::dps_500}, 17.5e-3F, 499.0F},
        Range<Settings>{{.full_scale = FullScale::dps_1000}, 35e-3F, 999.0F},
        Range<Settings>{{.full_scale = FullScale::dps_2000}, 70e-3F, 1999.0F},
        Range<Settings>{{.full_scale = FullScale::dps_4000}, 140e-3F, 3999.0F}};
    std::array<Range<Settings>, kAll.size() - (kHas4000Dps ? 0 : 1)> ranges{};
    std::copy_n(kAll.begin(), ranges.size(), ranges.begin());
    return ranges;
  }();
  static constexpr float kLsbDps = 8.75e-3F;
  static constexpr float kFullScaleDps = 250.0F;
  static constexpr std::int16_t kLowestRaw = -32768;
  static constexpr float kTemperatureLsb = 1.0F / 256.0F;
  static constexpr bool kFramesAreMarked = true;
  static constexpr std::size_t kVerifyTransactions = 1;
  static constexpr bool kIsSampledByReading = false;
  static constexpr std::size_t kFifoCapacity = 512;
  static constexpr bool kHasWatermark = true;

  static constexpr std::uint8_t kIdentity = 0x0F;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x12, 0xFF}, ConfiguredBits{0x18, 0x02}, ConfiguredBits{0x13, 0x42},
      ConfiguredBits{0x16, 0xC0}, ConfiguredBits{0x10, 0xF0}, ConfiguredBits{0x0D, 0xFF},
      ConfiguredBits{0x07, 0xFF}, ConfiguredBits{0x08, 0xD1}, ConfiguredBits{0x09, 0xFF},
      ConfiguredBits{0x0A, 0xF7}, ConfiguredBits{0x11, 0xFF}};
  static constexpr core::Duration kStartTime = core::Duration::microseconds(50);
  /// When the first sample may come after start() succeeded, and when it must: 70 ms and three
  /// samples of 104 Hz, and two more.
  static constexpr core::Duration kEarliest = core::Duration::microseconds(98'800);
  static constexpr core::Duration kLatest = core::Duration::microseconds(118'100);
};

struct Lsm6dso : Lsm6Family<hal::sim::SimulatedLsm6dso, drivers::lsm6dso::Settings, false> {
  static constexpr const char* kName = "Lsm6dso";
};

struct Ism330dhcx
    : Lsm6Family<hal::sim::SimulatedIsm330dhcx, drivers::lsm6dso::Ism330dhcx::Settings, true> {
  static constexpr const char* kName = "Ism330dhcx";
};

struct Asm330lhh
    : Lsm6Family<hal::sim::SimulatedAsm330lhh, drivers::lsm6dso::Asm330lhh::Settings, true> {
  static constexpr const char* kName = "Asm330lhh";
};

struct Lsm6dsr : Lsm6Family<hal::sim::SimulatedLsm6dsr, drivers::lsm6dso::Lsm6dsr::Settings, true> {
  static constexpr const char* kName = "Lsm6dsr";
};

struct Lsm6dsox
    : Lsm6Family<hal::sim::SimulatedLsm6dsox, drivers::lsm6dso::Lsm6dsox::Settings, false> {
  static constexpr const char* kName = "Lsm6dsox";
};

/// The older ones, whose FIFO is not used and has other registers at the same addresses.
template <class SimulatedChip, class SettingsOfChip>
struct Lsm6dslFamily : Lsm6Family<SimulatedChip, SettingsOfChip, false> {
  static constexpr SettingsOfChip kFifo{.fifo_watermark = 200};  // none
  static constexpr std::size_t kFifoCapacity = 0;
  static constexpr std::array kConfigured{ConfiguredBits{0x12, 0xFF}, ConfiguredBits{0x13, 0x42},
                                          ConfiguredBits{0x16, 0xC0}, ConfiguredBits{0x10, 0xF0},
                                          ConfiguredBits{0x0D, 0xFF}, ConfiguredBits{0x07, 0xFF},
                                          ConfiguredBits{0x08, 0xD1}, ConfiguredBits{0x09, 0xFF},
                                          ConfiguredBits{0x0A, 0xF7}, ConfiguredBits{0x11, 0xFF}};
};
struct Lsm6dsl : Lsm6dslFamily<hal::sim::SimulatedLsm6dsl, drivers::lsm6dso::Lsm6dsl::Settings> {
  static constexpr const char* kName = "Lsm6dsl";
};
struct Lsm6ds3trC
    : Lsm6dslFamily<hal::sim::SimulatedLsm6ds3trC, drivers::lsm6dso::Lsm6ds3trC::Settings> {
  static constexpr const char* kName = "Lsm6ds3trC";
};

/// The youngest, with its range in another register.
struct Lsm6dsv16x
    : Lsm6Family<hal::sim::SimulatedLsm6dsv16x, drivers::lsm6dso::Lsm6dsv16x::Settings, true> {
  static constexpr const char* kName = "Lsm6dsv16x";
  static constexpr std::size_t kFifoCapacity = 256;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x12, 0xFF}, ConfiguredBits{0x15, 0x7F}, ConfiguredBits{0x13, 0x0A},
      ConfiguredBits{0x16, 0x81}, ConfiguredBits{0x10, 0x0F}, ConfiguredBits{0x0D, 0xFF},
      ConfiguredBits{0x07, 0xFF}, ConfiguredBits{0x08, 0xD1}, ConfiguredBits{0x09, 0xFF},
      ConfiguredBits{0x0A, 0xF7}, ConfiguredBits{0x11, 0x7F}};
  /// 70 ms and three samples of 120 Hz, and two more.
  static constexpr core::Duration kEarliest = core::Duration::microseconds(95'000);
  static constexpr core::Duration kLatest = core::Duration::microseconds(111'700);
};

/// ST's gyros without an accelerometer.
template <class SimulatedChip, class SettingsOfChip>
struct L3gFamily {
  using Simulated = SimulatedChip;
  using Settings = SettingsOfChip;
  using FullScale = drivers::l3gd20h::FullScale;
  template <class Bus>
  using Driver = drivers::L3gd20h<Bus>;
  static constexpr hal::I2cAddress kAddress{0x6A};

  static constexpr Settings kDataReady{.mode = drivers::l3gd20h::Mode::data_ready};
  static constexpr Settings kFifo{.mode = drivers::l3gd20h::Mode::fifo, .fifo_watermark = 3};
  static constexpr std::array kRanges{
      Range<Settings>{{.full_scale = FullScale::dps_250}, 8.75e-3F, 249.0F},
      Range<Settings>{{.full_scale = FullScale::dps_500}, 17.5e-3F, 499.0F},
      Range<Settings>{{.full_scale = FullScale::dps_2000}, 70e-3F, 1999.0F}};
  static constexpr float kLsbDps = 8.75e-3F;
  static constexpr float kFullScaleDps = 250.0F;
  static constexpr std::int16_t kLowestRaw = -32768;
  static constexpr float kTemperatureLsb = 0.0F;  // none
  static constexpr bool kFramesAreMarked = false;
  static constexpr std::size_t kVerifyTransactions = 1;
  static constexpr bool kIsSampledByReading = false;
  static constexpr std::size_t kFifoCapacity = 32;
  static constexpr bool kHasWatermark = true;

  static constexpr std::uint8_t kIdentity = 0x0F;
  static constexpr std::array kConfigured{ConfiguredBits{0x23, 0xFF}, ConfiguredBits{0x21, 0xFF},
                                          ConfiguredBits{0x22, 0xFF}, ConfiguredBits{0x24, 0x7F},
                                          ConfiguredBits{0x2E, 0xFF}, ConfiguredBits{0x20, 0xFF}};
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(10);
  /// 300 ms and three samples of 100 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(330);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(340);
};
struct L3gd20h : L3gFamily<hal::sim::SimulatedL3gd20h, drivers::l3gd20h::Settings> {
  static constexpr const char* kName = "L3gd20h";
  static constexpr std::array kConfigured{ConfiguredBits{0x23, 0xFF}, ConfiguredBits{0x39, 0x29},
                                          ConfiguredBits{0x21, 0xFF}, ConfiguredBits{0x22, 0xFF},
                                          ConfiguredBits{0x24, 0x7F}, ConfiguredBits{0x2E, 0xFF},
                                          ConfiguredBits{0x20, 0xFF}};
};
struct L3g4200d : L3gFamily<hal::sim::SimulatedL3g4200d, drivers::l3gd20h::L3g4200d::Settings> {
  static constexpr const char* kName = "L3g4200d";
  static constexpr hal::I2cAddress kAddress{0x68};
};

}  // namespace zerorate::support

/// @file
/// The gyros that there are, as the contract suite sees them: what a test has to know of a chip in
/// order to expect something of its driver. Numbers are the datasheets', not the drivers'.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/compile_time.hpp"
#include "core/base/time.hpp"
#include "drivers/chips/chips.hpp"
#include "drivers/common/register_access.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/chips.hpp"
#include "hal/testing/fault_injector.hpp"
#include "host_tests/support/gyro_description.hpp"
#include "host_tests/support/gyro_rig.hpp"
#include "host_tests/support/simulated_analog_gyros.hpp"
#include "host_tests/support/simulated_st_gyros.hpp"

namespace zerorate::support {

/// TDK's family, whose registers are the same in all of them.
template <class SimulatedChip, class SettingsOfChip>
struct Icm42Family {
  using Simulated = SimulatedChip;
  using Settings = SettingsOfChip;
  using FullScale = drivers::icm42688::FullScale;
  template <class Bus>
  using Driver = drivers::Icm42688<Bus>;
  static constexpr hal::I2cAddress kAddress{0x68};

  static constexpr Settings kDataReady{.mode = drivers::icm42688::Mode::data_ready};
  static constexpr Settings kFifo{.mode = drivers::icm42688::Mode::fifo, .fifo_watermark = 3};
  static constexpr std::array kRanges{
      Range<Settings>{{.full_scale = FullScale::dps_15_625}, 1.0F / 2097.152F, 15.6F},
      Range<Settings>{{.full_scale = FullScale::dps_31_25}, 1.0F / 1048.576F, 31.2F},
      Range<Settings>{{.full_scale = FullScale::dps_62_5}, 1.0F / 524.288F, 62.4F},
      Range<Settings>{{.full_scale = FullScale::dps_125}, 1.0F / 262.144F, 124.9F},
      Range<Settings>{{.full_scale = FullScale::dps_250}, 1.0F / 131.072F, 249.9F},
      Range<Settings>{{.full_scale = FullScale::dps_500}, 1.0F / 65.536F, 499.9F},
      Range<Settings>{{.full_scale = FullScale::dps_1000}, 1.0F / 32.768F, 999.0F},
      Range<Settings>{{.full_scale = FullScale::dps_2000}, 1.0F / 16.384F, 1999.0F}};
  static constexpr float kLsbDps = 1.0F / 131.072F;
  static constexpr float kFullScaleDps = 250.0F;
  static constexpr std::int16_t kLowestRaw = -32766;
  static constexpr float kTemperatureLsb = 1.0F / 132.48F;
  static constexpr bool kFramesAreMarked = true;
  static constexpr std::size_t kVerifyTransactions = 1;
  static constexpr bool kIsSampledByReading = false;
  static constexpr std::size_t kFifoCapacity = 256;
  static constexpr bool kHasWatermark = true;

  static constexpr std::uint8_t kIdentity = 0x75;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x76, 0x07}, ConfiguredBits{0x4C, 0xF0}, ConfiguredBits{0x4D, 0xC0},
      ConfiguredBits{0x14, 0x07}, ConfiguredBits{0x64, 0x10}, ConfiguredBits{0x65, 0x7F},
      ConfiguredBits{0x52, 0x0F}, ConfiguredBits{0x5F, 0x7F}, ConfiguredBits{0x60, 0xFF},
      ConfiguredBits{0x61, 0x0F}, ConfiguredBits{0x16, 0xC0}, ConfiguredBits{0x4F, 0xEF},
      ConfiguredBits{0x4E, 0x3F}};
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(1);
  /// 60 ms and three samples of 100 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(90);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(100);
};

struct Icm42688 : Icm42Family<hal::sim::SimulatedIcm42688, drivers::icm42688::Settings> {
  static constexpr const char* kName = "Icm42688";
};
struct Icm42605 : Icm42Family<hal::sim::SimulatedIcm42605, drivers::icm42688::Icm42605::Settings> {
  static constexpr const char* kName = "Icm42605";
};
struct Iim42652 : Icm42Family<hal::sim::SimulatedIim42652, drivers::icm42688::Iim42652::Settings> {
  static constexpr const char* kName = "Iim42652";
};

struct Icm45686 : Icm42688 {
  static constexpr const char* kName = "Icm45686";
  using Simulated = hal::sim::SimulatedIcm45686;
  using Settings = drivers::icm45686::Settings;
  using FullScale = drivers::icm45686::FullScale;
  template <class Bus>
  using Driver = drivers::Icm45686<Bus>;

  static constexpr Settings kDataReady{.mode = drivers::icm45686::Mode::data_ready};
  static constexpr Settings kFifo{.mode = drivers::icm45686::Mode::fifo, .fifo_watermark = 3};
  static constexpr std::array kRanges{
      Range<Settings>{{.full_scale = FullScale::dps_15_625}, 1.0F / 2097.152F, 15.6F},
      Range<Settings>{{.full_scale = FullScale::dps_31_25}, 1.0F / 1048.576F, 31.2F},
      Range<Settings>{{.full_scale = FullScale::dps_62_5}, 1.0F / 524.288F, 62.4F},
      Range<Settings>{{.full_scale = FullScale::dps_125}, 1.0F / 262.144F, 124.9F},
      Range<Settings>{{.full_scale = FullScale::dps_250}, 1.0F / 131.072F, 249.9F},
      Range<Settings>{{.full_scale = FullScale::dps_500}, 1.0F / 65.536F, 499.9F},
      Range<Settings>{{.full_scale = FullScale::dps_1000}, 1.0F / 32.768F, 999.0F},
      Range<Settings>{{.full_scale = FullScale::dps_2000}, 1.0F / 16.384F, 1999.0F},
      Range<Settings>{{.full_scale = FullScale::dps_4000}, 1.0F / 8.192F, 3998.0F}};
  static constexpr float kTemperatureLsb = 1.0F / 128.0F;

  static constexpr std::uint8_t kIdentity = 0x72;
  /// Bit 7 of an address is a register behind the window.
  static constexpr std::array kConfigured{
      ConfiguredBits{0x32, 0x0E}, ConfiguredBits{0x18, 0x07}, ConfiguredBits{0x16, 0xFF},
      ConfiguredBits{0x20, 0x08}, ConfiguredBits{0x1E, 0xFF}, ConfiguredBits{0x1F, 0xFF},
      ConfiguredBits{0x22, 0x07}, ConfiguredBits{0x1C, 0xFF}, ConfiguredBits{0x80, 0x02},
      ConfiguredBits{0x10, 0x0F}, ConfiguredBits{0x81, 0x07}, ConfiguredBits{0x83, 0x09},
      ConfiguredBits{0x1D, 0xFF}, ConfiguredBits{0x21, 0x3F}};
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(2);
  /// 70 ms and three samples of 100 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(100);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(110);
};

struct Bmi088 {
  static constexpr const char* kName = "Bmi088";
  using Simulated = hal::sim::SimulatedBmi088;
  using Settings = drivers::bmi088::Settings;
  using FullScale = drivers::bmi088::FullScale;
  template <class Bus>
  using Driver = drivers::Bmi088<Bus>;
  static constexpr hal::I2cAddress kAddress{0x68};

  static constexpr Settings kDataReady{.mode = drivers::bmi088::Mode::data_ready};
  static constexpr Settings kFifo{.mode = drivers::bmi088::Mode::fifo, .fifo_watermark = 3};
  static constexpr std::array kRanges{
      Range<Settings>{{.full_scale = FullScale::dps_125}, 1.0F / 262.144F, 124.9F},
      Range<Settings>{{.full_scale = FullScale::dps_250}, 1.0F / 131.072F, 249.9F},
      Range<Settings>{{.full_scale = FullScale::dps_500}, 1.0F / 65.536F, 499.9F},
      Range<Settings>{{.full_scale = FullScale::dps_1000}, 1.0F / 32.768F, 999.0F},
      Range<Settings>{{.full_scale = FullScale::dps_2000}, 1.0F / 16.384F, 1999.0F}};
  static constexpr float kLsbDps = 1.0F / 131.072F;
  static constexpr float kFullScaleDps = 250.0F;
  static constexpr std::int16_t kLowestRaw = -32768;
  static constexpr float kTemperatureLsb = 0.0F;  // none
  static constexpr bool kFramesAreMarked = false;
  static constexpr std::size_t kVerifyTransactions = 1;
  static constexpr bool kIsSampledByReading = false;
  static constexpr std::size_t kFifoCapacity = 100;
  static constexpr bool kHasWatermark = true;

  static constexpr std::uint8_t kIdentity = 0x00;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x1E, 0x88}, ConfiguredBits{0x11, 0xA0}, ConfiguredBits{0x0F, 0x07},
      ConfiguredBits{0x10, 0x0F}, ConfiguredBits{0x16, 0x03}, ConfiguredBits{0x18, 0xA5},
      ConfiguredBits{0x15, 0xC0}, ConfiguredBits{0x3D, 0xFF}, ConfiguredBits{0x3E, 0xC0}};
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(30);
  /// 30 ms and ten samples of 100 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(130);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(140);
};

/// InvenSense's older family.
template <class SimulatedChip, class SettingsOfChip>
struct Mpu6Family {
  using Simulated = SimulatedChip;
  using Settings = SettingsOfChip;
  using FullScale = drivers::mpu6500::FullScale;
  template <class Bus>
  using Driver = drivers::Mpu6500<Bus>;
  static constexpr hal::I2cAddress kAddress{0x68};

  static constexpr Settings kDataReady{.mode = drivers::mpu6500::Mode::data_ready};
  static constexpr Settings kFifo{.mode = drivers::mpu6500::Mode::fifo};
  static constexpr std::array kRanges{
      Range<Settings>{{.full_scale = FullScale::dps_250}, 1.0F / 131.072F, 249.9F},
      Range<Settings>{{.full_scale = FullScale::dps_500}, 1.0F / 65.536F, 499.9F},
      Range<Settings>{{.full_scale = FullScale::dps_1000}, 1.0F / 32.768F, 999.0F},
      Range<Settings>{{.full_scale = FullScale::dps_2000}, 1.0F / 16.384F, 1999.0F}};
  static constexpr float kLsbDps = 1.0F / 131.072F;
  static constexpr float kFullScaleDps = 250.0F;
  static constexpr std::int16_t kLowestRaw = -32768;
  static constexpr float kTemperatureLsb = 1.0F / 333.87F;
  /// They are not, but a flipped bit makes of the level no multiple of a sample.
  static constexpr bool kFramesAreMarked = true;
  static constexpr std::size_t kVerifyTransactions = 1;
  static constexpr bool kIsSampledByReading = false;
  static constexpr std::size_t kFifoCapacity = 85;
  static constexpr bool kHasWatermark = false;

  static constexpr std::uint8_t kIdentity = 0x75;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x6B, 0xFF}, ConfiguredBits{0x6C, 0x3F}, ConfiguredBits{0x1A, 0x7F},
      ConfiguredBits{0x19, 0xFF}, ConfiguredBits{0x1B, 0xFB}, ConfiguredBits{0x37, 0xFE},
      ConfiguredBits{0x38, 0x79}, ConfiguredBits{0x23, 0xFF}, ConfiguredBits{0x6A, 0xF0}};
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(200);
  /// 70 ms and three samples of 100 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(100);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(110);
};

struct Mpu6500 : Mpu6Family<hal::sim::SimulatedMpu6500, drivers::mpu6500::Settings> {
  static constexpr const char* kName = "Mpu6500";
  /// Answers that the driver takes, copies included.
  static constexpr std::array<std::uint8_t, 7> kIdentities{0x68, 0x70, 0x71, 0x72,
                                                           0x73, 0x74, 0x98};
};

struct Icm20689 : Mpu6Family<hal::sim::SimulatedIcm20689, drivers::mpu6500::Icm20689::Settings> {
  static constexpr const char* kName = "Icm20689";
  static constexpr float kTemperatureLsb = 1.0F / 326.8F;
};

/// The younger ones, with 1008 bytes of FIFO and eight bytes a sample.
template <class SimulatedChip, class SettingsOfChip>
struct Icm206Family : Mpu6Family<SimulatedChip, SettingsOfChip> {
  static constexpr float kTemperatureLsb = 1.0F / 326.8F;
  static constexpr std::size_t kFifoCapacity = 126;
  static constexpr std::array kConfigured{ConfiguredBits{0x6B, 0xFF}, ConfiguredBits{0x70, 0x40},
                                          ConfiguredBits{0x6C, 0x3F}, ConfiguredBits{0x1A, 0x7F},
                                          ConfiguredBits{0x19, 0xFF}, ConfiguredBits{0x1B, 0xFB},
                                          ConfiguredBits{0x37, 0xFE}, ConfiguredBits{0x38, 0x79},
                                          ConfiguredBits{0x23, 0xFF}, ConfiguredBits{0x6A, 0xF0}};
  /// 100 ms and three samples of 100 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(130);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(140);
};
struct Icm20602 : Icm206Family<hal::sim::SimulatedIcm20602, drivers::mpu6500::Icm20602::Settings> {
  static constexpr const char* kName = "Icm20602";
};
struct Mpu6886 : Icm206Family<hal::sim::SimulatedMpu6886, drivers::mpu6500::Mpu6886::Settings> {
  static constexpr const char* kName = "Mpu6886";
};

/// The older relative, with another thermometer and twice the FIFO.
struct Mpu6050 : Mpu6500 {
  static constexpr const char* kName = "Mpu6050";
  using Simulated = hal::sim::SimulatedMpu6050;
  static constexpr float kTemperatureLsb = 1.0F / 340.0F;
  static constexpr std::size_t kFifoCapacity = 170;
};

struct Bmi160 {
  static constexpr const char* kName = "Bmi160";
  using Simulated = hal::sim::SimulatedBmi160;
  using Settings = drivers::bmi160::Settings;
  using FullScale = drivers::bmi160::FullScale;
  template <class Bus>
  using Driver = drivers::Bmi160<Bus>;
  static constexpr hal::I2cAddress kAddress{0x68};

  static constexpr Settings kDataReady{.mode = drivers::bmi160::Mode::data_ready};
  static constexpr Settings kFifo{.mode = drivers::bmi160::Mode::fifo, .fifo_watermark = 3};
  static constexpr std::array kRanges{
      Range<Settings>{{.full_scale = FullScale::dps_125}, 1.0F / 262.144F, 124.9F},
      Range<Settings>{{.full_scale = FullScale::dps_250}, 1.0F / 131.072F, 249.9F},
      Range<Settings>{{.full_scale = FullScale::dps_500}, 1.0F / 65.536F, 499.9F},
      Range<Settings>{{.full_scale = FullScale::dps_1000}, 1.0F / 32.768F, 999.0F},
      Range<Settings>{{.full_scale = FullScale::dps_2000}, 1.0F / 16.384F, 1999.0F}};
  static constexpr float kLsbDps = 1.0F / 131.072F;
  static constexpr float kFullScaleDps = 250.0F;
  static constexpr std::int16_t kLowestRaw = -32768;
  static constexpr float kTemperatureLsb = 1.0F / 512.0F;
  /// They are not, but a flipped bit makes of the level no multiple of a frame.
  static constexpr bool kFramesAreMarked = true;
  static constexpr std::size_t kVerifyTransactions = 1;
  static constexpr bool kIsSampledByReading = false;
  static constexpr std::size_t kFifoCapacity = 170;
  static constexpr bool kHasWatermark = true;

  static constexpr std::uint8_t kIdentity = 0x00;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x45, 0xFF}, ConfiguredBits{0x42, 0x3F}, ConfiguredBits{0x43, 0x07},
      ConfiguredBits{0x46, 0xFF}, ConfiguredBits{0x51, 0x7F}, ConfiguredBits{0x53, 0x0F},
      ConfiguredBits{0x54, 0x1F}, ConfiguredBits{0x56, 0xF0}, ConfiguredBits{0x47, 0xFE}};
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(95);
  /// 30 ms and three samples of 100 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(60);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(70);
};

struct Bmi270 : Bmi160 {
  static constexpr const char* kName = "Bmi270";
  using Simulated = hal::sim::SimulatedBmi270;
  using Settings = drivers::bmi270::Settings;
  using FullScale = drivers::bmi270::FullScale;
  template <class Bus>
  using Driver = drivers::Bmi270<Bus>;
  template <class Device>
  using Spi = drivers::SpiRegistersWithDummy<Device>;

  static constexpr Settings kDataReady{.mode = drivers::bmi270::Mode::data_ready};
  static constexpr Settings kFifo{.mode = drivers::bmi270::Mode::fifo, .fifo_watermark = 3};
  static constexpr std::array kRanges{
      Range<Settings>{{.full_scale = FullScale::dps_125}, 1.0F / 262.144F, 124.9F},
      Range<Settings>{{.full_scale = FullScale::dps_250}, 1.0F / 131.072F, 249.9F},
      Range<Settings>{{.full_scale = FullScale::dps_500}, 1.0F / 65.536F, 499.9F},
      Range<Settings>{{.full_scale = FullScale::dps_1000}, 1.0F / 32.768F, 999.0F},
      Range<Settings>{{.full_scale = FullScale::dps_2000}, 1.0F / 16.384F, 1999.0F}};
  static constexpr std::size_t kFifoCapacity = 341;
  static constexpr std::array kConfigured{
      ConfiguredBits{0x7C, 0x07}, ConfiguredBits{0x45, 0xFF}, ConfiguredBits{0x42, 0xFF},
      ConfiguredBits{0x43, 0x0F}, ConfiguredBits{0x46, 0xFF}, ConfiguredBits{0x47, 0x1F},
      ConfiguredBits{0x48, 0x03}, ConfiguredBits{0x53, 0x1E}, ConfiguredBits{0x55, 0x01},
      ConfiguredBits{0x58, 0x0F}, ConfiguredBits{0x49, 0xF0}, ConfiguredBits{0x7D, 0x0F}};
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(160);
  /// 85 ms and three samples of 100 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(115);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(125);
};

struct Icm20948 {
  static constexpr const char* kName = "Icm20948";
  using Simulated = hal::sim::SimulatedIcm20948;
  using Settings = drivers::icm20948::Settings;
  using FullScale = drivers::icm20948::FullScale;
  template <class Bus>
  using Driver = drivers::Icm20948<Bus>;
  static constexpr hal::I2cAddress kAddress{0x68};

  static constexpr Settings kDataReady{.mode = drivers::icm20948::Mode::data_ready};
  static constexpr Settings kFifo{.mode = drivers::icm20948::Mode::fifo};
  static constexpr std::array kRanges{
      Range<Settings>{{.full_scale = FullScale::dps_250}, 1.0F / 131.072F, 249.9F},
      Range<Settings>{{.full_scale = FullScale::dps_500}, 1.0F / 65.536F, 499.9F},
      Range<Settings>{{.full_scale = FullScale::dps_1000}, 1.0F / 32.768F, 999.0F},
      Range<Settings>{{.full_scale = FullScale::dps_2000}, 1.0F / 16.384F, 1999.0F}};
  static constexpr float kLsbDps = 1.0F / 131.072F;
  static constexpr float kFullScaleDps = 250.0F;
  static constexpr std::int16_t kLowestRaw = -32768;
  static constexpr float kTemperatureLsb = 1.0F / 333.87F;
  /// They are not, but a flipped bit makes of the level no multiple of a sample.
  static constexpr bool kFramesAreMarked = true;
  static constexpr std::size_t kVerifyTransactions = 1;
  static constexpr bool kIsSampledByReading = false;
  static constexpr std::size_t kFifoCapacity = 85;
  static constexpr bool kHasWatermark = false;

  static constexpr std::uint8_t kIdentity = 0x00;
  /// Bit 7 of an address is bank 2.
  static constexpr std::array kConfigured{
      ConfiguredBits{0x06, 0xFF}, ConfiguredBits{0x05, 0x30}, ConfiguredBits{0x07, 0x3F},
      ConfiguredBits{0x80, 0xFF}, ConfiguredBits{0x81, 0x3F}, ConfiguredBits{0x82, 0x38},
      ConfiguredBits{0x0F, 0xFE}, ConfiguredBits{0x10, 0x8F}, ConfiguredBits{0x11, 0x01},
      ConfiguredBits{0x12, 0x1F}, ConfiguredBits{0x13, 0x1F}, ConfiguredBits{0x66, 0x0F},
      ConfiguredBits{0x69, 0x1F}, ConfiguredBits{0x67, 0x1F}, ConfiguredBits{0x03, 0xF0}};
  static constexpr core::Duration kStartTime = core::Duration::milliseconds(200);
  /// 70 ms and three samples of 125 Hz, and one more.
  static constexpr core::Duration kEarliest = core::Duration::milliseconds(94);
  static constexpr core::Duration kLatest = core::Duration::milliseconds(104);
};

/// How a chip is attached.
template <class G>
struct OverSpi {
  using Gyro = G;
  using Bus = hal::sim::SimulatedSpi<typename G::Simulated>;
  using Link = drivers::SpiLink<G, hal::testing::FaultInjector<Bus>>;
  using Driver = typename G::template Driver<Link>;
  static Bus attach(typename G::Simulated& chip) { return Bus{chip}; }
  static Link link(hal::testing::FaultInjector<Bus>& bus) { return Link{bus}; }
};
template <class G>
struct OverI2c {
  using Gyro = G;
  using Bus = hal::sim::SimulatedI2cBus<typename G::Simulated>;
  using Link = drivers::I2cRegisters<hal::testing::FaultInjector<Bus>>;
  using Driver = typename G::template Driver<Link>;
  static Bus attach(typename G::Simulated& chip) { return Bus{chip, G::kAddress}; }
  static Link link(hal::testing::FaultInjector<Bus>& bus) { return Link{bus, G::kAddress}; }
};

/// Every chip with a FIFO in every wiring, or in one where it differs from another by its name.
using WiringsWithFifo = core::TypeList<
    OverSpi<Lsm6dso>, OverI2c<Lsm6dso>, OverSpi<Icm42688>, OverI2c<Icm42688>, OverSpi<Bmi088>,
    OverI2c<Bmi088>, OverSpi<Mpu6500>, OverI2c<Mpu6500>, OverI2c<Mpu6050>, OverSpi<Ism330dhcx>,
    OverI2c<Ism330dhcx>, OverSpi<Asm330lhh>, OverI2c<Asm330lhh>, OverSpi<Lsm6dsv16x>,
    OverI2c<Lsm6dsv16x>, OverSpi<Lsm6dsr>, OverI2c<Lsm6dsox>, OverSpi<Icm42605>, OverI2c<Iim42652>,
    OverSpi<Icm20689>, OverSpi<Icm20602>, OverI2c<Icm20602>, OverI2c<Mpu6886>, OverSpi<L3gd20h>,
    OverI2c<L3gd20h>, OverSpi<Bmi160>, OverI2c<Bmi160>, OverI2c<L3g4200d>, OverSpi<Icm20948>,
    OverI2c<Icm20948>, OverSpi<Bmi270>, OverI2c<Bmi270>, OverSpi<Icm45686>, OverI2c<Icm45686>>;
/// The other chips.
using WiringsWithoutFifo =
    core::TypeList<OverSpi<Adxrs453>, OverSpi<Lsm6dsl>, OverI2c<Lsm6ds3trC>, OverSpi<Adis16470>,
                   OverSpi<Adis16475Part1>, OverSpi<Adis16475Part2>>;

}  // namespace zerorate::support

/// @file
/// Particulars of the LSM6DSO and of its codec; the rest is in host_tests/contract.

#include "drivers/lsm6dso/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/lsm6dso/codec.hpp"
#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::drivers::lsm6dso {
namespace {

constexpr std::int16_t kMin = std::numeric_limits<std::int16_t>::min();
constexpr std::int16_t kMax = std::numeric_limits<std::int16_t>::max();

struct Range {
  FullScale full_scale;
  double full_scale_dps;
  double mdps_per_lsb;  // DS12140, table 2
};
constexpr std::array kRanges{
    Range{FullScale::dps_125, 125, 4.375}, Range{FullScale::dps_250, 250, 8.75},
    Range{FullScale::dps_500, 500, 17.5},  Range{FullScale::dps_1000, 1000, 35},
    Range{FullScale::dps_2000, 2000, 70},  Range{FullScale::dps_4000, 4000, 140}};

double rad_s(double mdps) {
  return mdps * 1e-3 * std::numbers::pi / 180.0;
}

TEST(Lsb, IsTheSensitivityOfTheDatasheetToFloatAccuracy) {
  // Three roundings in single precision: of the sensitivity, of pi / 180 and of their product; each
  // is at most 2^-24 of the value.
  const double tolerance = 3.0 * std::exp2(-24);
  for (const Range& range : kRanges) {
    const double expected = rad_s(range.mdps_per_lsb);
    EXPECT_NEAR(lsb(range.full_scale).in(core::rad_per_s), expected, expected * tolerance);
  }
}

TEST(FullScaleRaw, IsTheNominalFullScaleInEveryRange) {
  for (const Range& range : kRanges) {
    EXPECT_EQ(static_cast<int>(range.full_scale_dps * 1000.0 / range.mdps_per_lsb), kFullScaleRaw);
  }
}

TEST(Temperature, Is25DegreesAtZeroAnd256CountsADegree) {
  EXPECT_EQ(decode_temperature(0).degc(), 25.0F);
  EXPECT_EQ(decode_temperature(256).degc(), 26.0F);
  EXPECT_EQ(decode_temperature(-256 * 65).degc(), -40.0F);
  EXPECT_EQ(decode_temperature(kMin).degc(), -103.0F);
  EXPECT_EQ(decode_temperature(kMax).degc(), 153.0F - 1.0F / 256.0F);
}

constexpr const Variant& kDsv = variant(Part::lsm6dsv16x);

constexpr std::uint8_t code(auto rate) {
  return static_cast<std::uint8_t>(rate);
}

TEST(Ctrl2G, HoldsRateAboveRange) {
  EXPECT_EQ(encode_ctrl2_g(code(OutputDataRate::hz_104), FullScale::dps_250), 0x40);
  EXPECT_EQ(encode_ctrl2_g(code(OutputDataRate::hz_416), FullScale::dps_125), 0x62);
  EXPECT_EQ(encode_ctrl2_g(code(OutputDataRate::hz_6664), FullScale::dps_2000), 0xAC);
  EXPECT_EQ(encode_ctrl2_g(code(OutputDataRate::hz_104), FullScale::dps_4000), 0x41);
}

TEST(Ctrl6, HoldsTheRangeOfTheLsm6dsv16x) {
  constexpr std::array<std::uint8_t, kRanges.size()> kCodes{0x0, 0x1, 0x2, 0x3, 0x4, 0xC};
  for (std::size_t i = 0; i < kRanges.size(); ++i) {
    EXPECT_EQ(encode_ctrl6(kRanges.at(i).full_scale), kCodes.at(i));
  }
}

TEST(FifoStatus, HasNineBitsOfLevelInTheLsm6dsv16x) {
  EXPECT_EQ(decode_fifo_status(kDsv, 0x00, 0xE1).words, 256);
  EXPECT_TRUE(decode_fifo_status(kDsv, 0x00, 0xE9).is_overrun);
  EXPECT_TRUE(decode_fifo_status(kDsv, 0xFF, 0xF9).is_plausible);
  EXPECT_FALSE(decode_fifo_status(kDsv, 0x00, 0xE2).is_plausible);
  EXPECT_FALSE(decode_fifo_status(kDsv, 0xFF, 0xFF).is_plausible);
}

TEST(GyroTag, HasNoParityInTheLsm6dsv16x) {
  EXPECT_TRUE(is_gyro_tag(kDsv, 0b00001'00'0));
  EXPECT_TRUE(is_gyro_tag(kDsv, 0b00001'11'1));
  EXPECT_FALSE(is_gyro_tag(kDsv, 0b00010'00'0)) << "accelerometer";
  EXPECT_FALSE(is_gyro_tag(kDsv, 0b00000'00'0)) << "empty";
}

TEST(FifoStatus, JoinsTheTenBitsOfTheLevel) {
  EXPECT_EQ(decode_fifo_status(kLsm6dso, 0xFF, 0x03).words, 1023);
  EXPECT_EQ(decode_fifo_status(kLsm6dso, 0x00, 0xE2).words, 512);
  EXPECT_FALSE(decode_fifo_status(kLsm6dso, 0x00, 0xE2).is_overrun);
  EXPECT_TRUE(decode_fifo_status(kLsm6dso, 0x00, 0xEA).is_overrun);
  EXPECT_TRUE(decode_fifo_status(kLsm6dso, 0x00, 0xFB).is_plausible);
  EXPECT_FALSE(decode_fifo_status(kLsm6dso, 0xFF, 0xFF).is_plausible);
}

TEST(GyroTag, NeedsTheSensorAndEvenParity) {
  EXPECT_TRUE(is_gyro_tag(kLsm6dso, 0b00001'00'1));
  EXPECT_TRUE(is_gyro_tag(kLsm6dso, 0b00001'01'0));
  EXPECT_TRUE(is_gyro_tag(kLsm6dso, 0b00001'11'1));
  EXPECT_FALSE(is_gyro_tag(kLsm6dso, 0b00001'00'0)) << "parity";
  EXPECT_FALSE(is_gyro_tag(kLsm6dso, 0b00010'00'1)) << "accelerometer";
  EXPECT_FALSE(is_gyro_tag(kLsm6dso, 0b00011'00'0)) << "temperature";
}

TEST(Period, FollowsTheOscillatorsTrim) {
  for (unsigned rate = 1; rate <= 10; ++rate) {
    for (const int trim : {-128, -1, 0, 1, 127}) {
      const double hz = 6667.0 * (1.0 + 0.0015 * trim) * std::exp2(static_cast<int>(rate) - 10);
      const auto period = decode_period(kLsm6dso, rate, static_cast<std::int8_t>(trim));
      EXPECT_NEAR(static_cast<double>(period.ns()), 1e9 / hz, 1.0) << rate << ' ' << trim;
    }
  }
}

TEST(Period, OfTheLsm6dsv16xIsOfAnotherOscillator) {
  double nominal_hz = 7.5;
  for (unsigned rate = 2; rate <= 12; ++rate, nominal_hz *= 2.0) {
    for (const int trim : {-128, 0, 127}) {
      const double hz = nominal_hz * (1.0 + 0.0013 * trim);
      const auto period = decode_period(kDsv, rate, static_cast<std::int8_t>(trim));
      EXPECT_NEAR(static_cast<double>(period.ns()), 1e9 / hz, 1.0) << rate << ' ' << trim;
    }
  }
}

TEST(SettlingTime, IsTheTurnOnTimeAndTheSamplesToDiscard) {
  const auto settling_ms = [](const Variant& variant, auto rate) {
    return settling_time(variant, code(rate), core::Duration::milliseconds(10)).ns() / 1'000'000;
  };
  EXPECT_EQ(settling_ms(kLsm6dso, OutputDataRate::hz_12_5), 70 + 30);
  EXPECT_EQ(settling_ms(kLsm6dso, OutputDataRate::hz_26), 70 + 40);
  EXPECT_EQ(settling_ms(kLsm6dso, OutputDataRate::hz_104), 70 + 40);
  EXPECT_EQ(settling_ms(kLsm6dso, OutputDataRate::hz_833), 70 + 40);
  EXPECT_EQ(settling_ms(kLsm6dso, OutputDataRate::hz_1666), 70 + 1360);
  EXPECT_EQ(settling_ms(kLsm6dso, OutputDataRate::hz_6664), 70 + 5410);
  EXPECT_EQ(settling_ms(kDsv, DsvRate::hz_7_5), 70 + 30);
  EXPECT_EQ(settling_ms(kDsv, DsvRate::hz_120), 70 + 40);
  EXPECT_EQ(settling_ms(kDsv, DsvRate::hz_7680), 70 + 5410);
}

}  // namespace
}  // namespace zerorate::drivers::lsm6dso

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using lsm6dso::Mode;
using lsm6dso::Settings;
using Rig = support::GyroRig<support::OverSpi<support::Lsm6dso>>;

constexpr Settings kFifo{.mode = Mode::fifo};

TEST(Lsm6dso, ConfiguresTheRegistersThatTheDatasheetNames) {
  Rig rig;
  rig.chip.upset(0x16, 0xC0);  // CTRL7_G: low-power mode and high-pass filter
  rig.chip.upset(0x13, 0x42);  // CTRL4_C: sleep, LPF1
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x16), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x13), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x12), 0x44);  // CTRL3_C: BDU, IF_INC
  EXPECT_EQ(rig.chip.read_register(0x11), 0x40);  // CTRL2_G: 104 Hz, 250 deg/s
  EXPECT_EQ(rig.chip.read_register(0x18), 0xE2);  // CTRL9_XL: reset value and I3C_disable
}

template <class Chip, class Driven>
core::Result<void, DriverError> started_as() {
  support::GyroRig<support::OverSpi<Driven>> rig;
  Chip chip{rig.clock};
  hal::sim::SimulatedSpiDevice<Chip> bus{chip};
  Lsm6dso driver{SpiRegisters{bus}, typename Driven::Settings{}};
  auto started = driver.start(rig.clock.now());
  rig.clock.advance(core::Duration::milliseconds(1));
  return support::is_waiting(started) ? driver.start(rig.clock.now()) : started;
}

TEST(Lsm6dsoRelatives, AreNotTakenForAnLsm6dsoNorTheOtherWayRound) {
  constexpr DriverError kWrong{DriverErrorCode::wrong_identity, {}, 0x0F};
  using hal::sim::SimulatedAsm330lhh;
  using hal::sim::SimulatedIsm330dhcx;
  using hal::sim::SimulatedLsm6dso;
  EXPECT_EQ((started_as<SimulatedIsm330dhcx, support::Lsm6dso>().error()), kWrong);
  EXPECT_EQ((started_as<SimulatedAsm330lhh, support::Lsm6dso>().error()), kWrong);
  EXPECT_EQ((started_as<SimulatedLsm6dso, support::Ism330dhcx>().error()), kWrong);
  EXPECT_EQ((started_as<SimulatedLsm6dso, support::Asm330lhh>().error()), kWrong);
  EXPECT_EQ((started_as<SimulatedLsm6dso, support::Lsm6dsv16x>().error()), kWrong);
  EXPECT_EQ((started_as<hal::sim::SimulatedLsm6dsv16x, support::Lsm6dso>().error()), kWrong);
}

TEST(Lsm6dsoRelatives, AreConfiguredInTheirOwnLayout) {
  support::GyroRig<support::OverSpi<support::Lsm6dsv16x>> rig{
      {.full_scale = lsm6dso::FullScale::dps_4000, .rate = lsm6dso::DsvRate::hz_240}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x11), 0x07);  // CTRL2: high performance, 240 Hz
  EXPECT_EQ(rig.chip.read_register(0x12), 0x44);  // CTRL3: BDU, IF_INC
  EXPECT_EQ(rig.chip.read_register(0x15), 0x0C);  // CTRL6: 4000 deg/s
  EXPECT_EQ(rig.chip.read_register(0x18), 0x00);  // CTRL9 is the accelerometer's: not touched
  EXPECT_NEAR(static_cast<double>(rig.chip.sample_period().ns()),
              static_cast<double>(rig.driver.sample_period().ns()), 1.0);
}

TEST(Lsm6dsoRelatives, ThatAnswerAlikeAreTakenForEachOther) {
  EXPECT_TRUE((started_as<hal::sim::SimulatedAsm330lhh, support::Ism330dhcx>()));
  EXPECT_TRUE((started_as<hal::sim::SimulatedIsm330dhcx, support::Asm330lhh>()));
  EXPECT_TRUE((started_as<hal::sim::SimulatedIsm330dhcx, support::Lsm6dsr>()));
  EXPECT_TRUE((started_as<hal::sim::SimulatedLsm6dso, support::Lsm6dsox>()));
  EXPECT_TRUE((started_as<hal::sim::SimulatedLsm6dsl, support::Lsm6ds3trC>()));
  EXPECT_FALSE((started_as<hal::sim::SimulatedLsm6dsl, support::Lsm6dso>()));
}

TEST(Lsm6dsoRelatives, WithoutTagsLeaveTheirFifoOff) {
  support::GyroRig<support::OverSpi<support::Lsm6dsl>> rig{{.fifo_watermark = 40}};
  for (const auto address : std::to_array<std::uint8_t>({0x06, 0x07, 0x08, 0x09, 0x0A}))
    rig.chip.upset(address, 0x3D);
  ASSERT_TRUE(rig.start());
  for (const auto address : std::to_array<std::uint8_t>({0x06, 0x07, 0x08, 0x09, 0x0A})) {
    EXPECT_EQ(rig.chip.read_register(address), 0x00) << int{address};
  }
  EXPECT_EQ(rig.chip.read_register(0x18), 0xE0) << "no I3C to switch off";
  EXPECT_EQ(rig.driver.sample_period(), rig.chip.sample_period());
  EXPECT_FALSE(lsm6dso::Lsm6dsl::kHasFifo);
  EXPECT_TRUE(lsm6dso::Lsm6dsox::kHasFifo);
}

TEST(Lsm6dsoRelatives, HaveOneRangeMore) {
  EXPECT_EQ(lsm6dso::Chip::kFullScales.size(), 5U);
  EXPECT_EQ(lsm6dso::Chip::kFullScales.back().value, 2000.0);
  EXPECT_EQ(lsm6dso::Ism330dhcx::kFullScales.back().value, 4000.0);
  EXPECT_EQ(lsm6dso::Asm330lhh::kFullScales.back().value, 4000.0);
  EXPECT_EQ(lsm6dso::Lsm6dsr::kFullScales.back().value, 4000.0);
  EXPECT_EQ(lsm6dso::Lsm6dsl::kFullScales.back().value, 2000.0);
}

TEST(Lsm6dso, ReportsARegisterThatDoesNotTakeItsValue) {
  // Identity, reset, identity, CTRL3_C; then the first entry: read, write and read back.
  Rig rig;
  rig.faults.inject({.kind = Fault::Kind::flipped_bit, .first = 6, .bit = 6});  // BDU
  const auto started = rig.start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error(), (DriverError{DriverErrorCode::configuration_lost, {}, 0x12}));
}

TEST(Lsm6dso, ReadsItsOwnPeriod) {
  Rig rig{{}, {}, std::int8_t{20}};  // 3 % fast
  EXPECT_NEAR(rig.driver.sample_period().in_seconds(), 64.0F / 6667.0F, 1e-8F);
  ASSERT_TRUE(rig.start());
  EXPECT_NEAR(rig.driver.sample_period().in_seconds(), 64.0F / 6667.0F / 1.03F, 1e-8F);
}

TEST(Lsm6dso, GivesNoSampleFromALineStuckAfterTheStatus) {
  for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
    Rig rig;
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({deg_per_s(1.0F), {}, {}});
    rig.faults.inject({.kind = kind, .first = rig.faults.calls() + 1});
    std::array<GyroSample, 4> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x1E}));
  }
}

TEST(Lsm6dsoFifo, GoesOnWithTheOldestThatIsLeftAfterAnOverrun) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  constexpr int kLost = 7;
  for (int i = 0; i < 512 + kLost; ++i) {
    rig.sample({deg_per_s(0.1F * static_cast<float>(i)), {}, {}});
  }
  std::array<GyroSample, 600> out{};
  const auto overrun = rig.read(out);
  ASSERT_FALSE(overrun);
  EXPECT_EQ(overrun.error().code, DriverErrorCode::fifo_overrun);
  ASSERT_EQ(rig.read(out).value_or(0), 512U);
  EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 0.1F * kLost, 0.005F);
  EXPECT_EQ(out[511].time, rig.clock.now());
}

TEST(Lsm6dsoFifo, FilledToTheBrimIsNotAnOverrun) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 512; ++i) rig.sample({});
  std::array<GyroSample, 600> out{};
  EXPECT_EQ(rig.read(out).value_or(0), 512U);
}

TEST(Lsm6dsoFifo, AFlippedTagIsCorruptData) {
  for (std::size_t bit = 0; bit < 8; ++bit) {
    Rig rig{kFifo};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({});
    rig.faults.inject(
        {.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls() + 2, .bit = bit});
    std::array<GyroSample, 4> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << bit;
    EXPECT_EQ(read.error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x78}));
  }
}

TEST(Lsm6dsoOnScriptedSpi, AsksForTheIdentityAndResetsTheChip) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedSpiDevice spi;
  spi.expect({writes({0x8F}), reads({0x6C})});
  spi.expect({writes({0x12, 0x05})});
  Lsm6dso driver{SpiRegisters{spi}};
  EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::not_ready);
}

/// Brown-out of a chip: each read gives 0, and a reset by writing alone cures it.
TEST(Lsm6dsoThatAnswersZeros, IsResetBlindlyAfterThreeIdentities) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedSpiDevice spi;
  for (int i = 0; i < 3; ++i) spi.expect({writes({0x8F}), reads({0x00})});
  spi.expect({writes({0x12, 0x05})});
  Lsm6dso driver{SpiRegisters{spi}};
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::wrong_identity);
  }
  EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::not_ready);
}

TEST(Lsm6dsoThatAnswersAsAnotherChip, IsNeverWrittenTo) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedSpiDevice spi;
  for (int i = 0; i < 10; ++i) spi.expect({writes({0x8F}), reads({0x47})});
  Lsm6dso driver{SpiRegisters{spi}};
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::wrong_identity);
  }
}

TEST(Lsm6dsoOnScriptedI2c, ReportsAFailureInATransaction) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedI2cBus i2c;
  i2c.expect(lsm6dso::kAddressSa0High, {writes({0x0F}), reads({0x6C})},
             hal::testing::FailureAt{1, hal::BusError::arbitration_lost});
  Lsm6dso driver{I2cRegisters{i2c, lsm6dso::kAddressSa0High}};
  EXPECT_EQ(driver.start({}).error(),
            (DriverError{DriverErrorCode::bus_failed, hal::BusError::arbitration_lost, 0x0F}));
}

}  // namespace
}  // namespace zerorate::drivers

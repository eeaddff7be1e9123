/// @file
/// Particulars of the BMI270 and of its codec; the rest is in host_tests/contract.

#include "drivers/bmi270/driver.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "host_tests/support/simulated_accelerometers.hpp"

namespace zerorate::drivers {
namespace {

using bmi270::FullScale;
using bmi270::Mode;
using bmi270::OutputDataRate;
using core::deg_per_s;
using Wiring = support::OverSpi<support::Bmi270>;
using Rig = support::GyroRig<Wiring>;
using I2cRig = support::GyroRig<support::OverI2c<support::Bmi270>>;
using AccelerationRig = support::GyroRig<support::OverSpi<support::Bmi270WithAcceleration>>;

/// Makes the rig's driver anew, with this file.
void give_file(Rig& rig, std::span<const std::uint8_t> file) {
  rig.driver = Rig::Driver{Wiring::link(rig.faults), {.config_file = file}};
}

TEST(Bmi270Lsb, IsTheFullScaleByTwoToThe15) {
  double dps = 2000.0;
  for (const FullScale full_scale : {FullScale::dps_2000, FullScale::dps_1000, FullScale::dps_500,
                                     FullScale::dps_250, FullScale::dps_125}) {
    const double expected = dps / 32768.0 * std::numbers::pi / 180.0;
    EXPECT_NEAR(bmi270::lsb(full_scale).in(core::rad_per_s), expected,
                expected * 3.0 * std::exp2(-24));
    dps /= 2.0;
  }
}

TEST(Bmi270AccelerationLsb, IsTheRangeByTwoToThe15) {
  using enum bmi270::AccelerationRange;
  float g = 2.0F;
  for (const auto range : {g_2, g_4, g_8, g_16}) {
    EXPECT_FLOAT_EQ(bmi270::acceleration_lsb(range).in(core::standard_gravity), g / 32768.0F);
    g *= 2.0F;
  }
}

TEST(Bmi270Temperature, Is23DegreesAtZero) {
  EXPECT_EQ(bmi270::decode_temperature(0).degc(), 23.0F);
  EXPECT_EQ(bmi270::decode_temperature(32767).degc(), 87.0F - 1.0F / 512.0F);
  EXPECT_EQ(bmi270::decode_temperature(-32767).degc(), -41.0F + 1.0F / 512.0F);
}

TEST(Bmi270InternalStatus, IsOneWhenTheFileWasTaken) {
  EXPECT_TRUE(bmi270::is_initialised(0x01));
  EXPECT_TRUE(bmi270::is_initialised(0x21)) << "axes remapped wrongly: none are";
  for (const unsigned status : {0x00U, 0x02U, 0x03U, 0x07U, 0xFFU}) {
    EXPECT_FALSE(bmi270::is_initialised(static_cast<std::uint8_t>(status)));
  }
}

TEST(Bmi270InitAddress, IsTheNumberOfTheWord) {
  EXPECT_EQ(bmi270::encode_init_address(0).low, 0x00);
  EXPECT_EQ(bmi270::encode_init_address(64).low, 0x00);
  EXPECT_EQ(bmi270::encode_init_address(64).high, 0x02);
  EXPECT_EQ(bmi270::encode_init_address(8190).low, 0x0F);
  EXPECT_EQ(bmi270::encode_init_address(8190).high, 0xFF);
}

TEST(Bmi270FifoLength, CountsFramesAndKeepsRoomForThree) {
  EXPECT_EQ(bmi270::decode_fifo_length(0x12, 0x00, 6).frames, 3);
  EXPECT_FALSE(bmi270::decode_fifo_length(0x12, 0x00, 12).is_whole);
  EXPECT_EQ(bmi270::decode_fifo_length(0x12, 0x80, 6).frames, 3) << "the level has 14 bits";
  EXPECT_FALSE(bmi270::decode_fifo_length(0xEC, 0x07, 6).is_overrun) << "2028 bytes";
  EXPECT_TRUE(bmi270::decode_fifo_length(0xF2, 0x07, 6).is_overrun) << "2034 bytes";
  EXPECT_TRUE(bmi270::decode_fifo_length(0x00, 0x08, 6).is_plausible);
  EXPECT_TRUE(bmi270::decode_fifo_length(0x00, 0x18, 6).is_overrun) << "6144 bytes";
  EXPECT_TRUE(bmi270::decode_fifo_length(0x00, 0x18, 6).is_plausible);
  EXPECT_FALSE(bmi270::decode_fifo_length(0x01, 0x18, 6).is_plausible);
}

TEST(Bmi270Placeholder, IsFoundByItsFirstTwoWords) {
  EXPECT_TRUE(bmi270::is_placeholder({0x7F02, -32768, -32768}));
  EXPECT_TRUE(bmi270::is_placeholder({0x7F02, -32768, 0}));
  EXPECT_FALSE(bmi270::is_placeholder({0x7F01, -32768, -32768})) << "the accelerometer's";
  EXPECT_FALSE(bmi270::is_placeholder({0x7F02, -32767, -32768}));
}

TEST(Bmi270CrossSensitivity, IsSevenBitsOfTwosComplementBy512) {
  EXPECT_EQ(bmi270::decode_cross_sensitivity(0x00), 0.0F);
  EXPECT_EQ(bmi270::decode_cross_sensitivity(0x03), 3.0F / 512.0F);
  EXPECT_EQ(bmi270::decode_cross_sensitivity(0x3F), 63.0F / 512.0F);
  EXPECT_EQ(bmi270::decode_cross_sensitivity(0x40), -64.0F / 512.0F);
  EXPECT_EQ(bmi270::decode_cross_sensitivity(0x7F), -1.0F / 512.0F);
  EXPECT_EQ(bmi270::decode_cross_sensitivity(0x83), 3.0F / 512.0F) << "bit 7 is reserved";
}

TEST(Bmi270, TakesTheRateAboutZOutOfX) {
  constexpr float kLsbDps = 250.0F / 32768.0F;
  for (const auto& settings : {support::Bmi270::kDataReady, support::Bmi270::kFifo}) {
    for (const int counts : {-64, -5, 0, 21, 63}) {
      Rig rig{settings};
      rig.chip.set_cross_sensitivity(counts);
      ASSERT_TRUE(rig.start_and_settle());
      rig.sample({deg_per_s(10.0F), deg_per_s(-20.0F), deg_per_s(200.0F)});
      std::array<GyroSample, 4> out{};
      ASSERT_EQ(rig.read(out).value_or(0), 1U);
      // Half a count of x, and of z times the factor.
      EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 10.0F, 0.57F * kLsbDps) << counts;
      EXPECT_NEAR(out[0].rate[1].in(deg_per_s), -20.0F, 0.51F * kLsbDps);
      EXPECT_NEAR(out[0].rate[2].in(deg_per_s), 200.0F, 0.51F * kLsbDps);
    }
  }
}

TEST(Bmi270, ReadsNoCrossSensitivityFromAFileWithoutFeatures) {
  EXPECT_TRUE(bmi270::has_features(8192));
  EXPECT_FALSE(bmi270::has_features(328));
}

TEST(Bmi270SamplePeriod, IsThatOfTheNamedRate) {
  EXPECT_EQ(bmi270::sample_period(OutputDataRate::hz_25), core::Duration::milliseconds(40));
  EXPECT_EQ(bmi270::sample_period(OutputDataRate::hz_1600), core::Duration::microseconds(625));
}

TEST(Bmi270, ConfiguresTheRegistersThatTheDatasheetNames) {
  AccelerationRig rig{{.full_scale = FullScale::dps_500,
                       .rate = OutputDataRate::hz_200,
                       .mode = Mode::fifo,
                       .fifo_watermark = 50}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x21), 0x01);  // INTERNAL_STATUS: initialised
  EXPECT_EQ(rig.chip.read_register(0x40), 0xA9);  // ACC_CONF: 200 Hz
  EXPECT_EQ(rig.chip.read_register(0x41), 0x01);  // ACC_RANGE: 4 g
  EXPECT_EQ(rig.chip.read_register(0x42), 0xE9);  // GYR_CONF: 200 Hz, lowest noise
  EXPECT_EQ(rig.chip.read_register(0x43), 0x02);  // GYR_RANGE: 500 deg/s
  EXPECT_EQ(rig.chip.read_register(0x46), 0x57);  // FIFO_WTM: 599 bytes
  EXPECT_EQ(rig.chip.read_register(0x47), 0x02);
  EXPECT_EQ(rig.chip.read_register(0x49), 0xC0);  // FIFO_CONFIG_1: both, without headers
  EXPECT_EQ(rig.chip.read_register(0x53), 0x0A);  // INT1_IO_CTRL: push-pull, active high
  EXPECT_EQ(rig.chip.read_register(0x58), 0x02);  // INT_MAP_DATA: watermark
  EXPECT_EQ(rig.chip.read_register(0x7D), 0x0E);  // PWR_CTRL: both, thermometer
  EXPECT_EQ(rig.chip.sample_period(), rig.driver.sample_period());
}

TEST(Bmi270, GivesItsInterfaceTimeToBecomeSpi) {
  Rig rig;
  EXPECT_TRUE(support::is_waiting(rig.driver.start(rig.clock.now())));
  EXPECT_EQ(rig.faults.calls(), 1U) << "a reading, for chip select to rise";
  rig.clock.advance(core::Duration::microseconds(1999));
  EXPECT_TRUE(support::is_waiting(rig.driver.start(rig.clock.now())));
  EXPECT_EQ(rig.faults.calls(), 1U);
  rig.clock.advance(core::Duration::microseconds(1));
  EXPECT_TRUE(support::is_waiting(rig.driver.start(rig.clock.now())));
  EXPECT_EQ(rig.faults.calls(), 3U) << "identity and reset";
  rig.clock.advance(core::Duration::milliseconds(10));
  EXPECT_TRUE(support::is_waiting(rig.driver.start(rig.clock.now())));
  EXPECT_EQ(rig.faults.calls(), 4U) << "once more, after the reset";
  EXPECT_TRUE(rig.start());
}

TEST(Bmi270, AsksForTheIdentityAtOnceOverI2c) {
  I2cRig rig;
  EXPECT_TRUE(support::is_waiting(rig.driver.start(rig.clock.now())));
  EXPECT_EQ(rig.faults.calls(), 2U) << "identity and reset";
}

TEST(Bmi270ConfigFile, IsLoadedAsItIs) {
  const auto file = hal::sim::SimulatedBmi270::config_file();
  Rig spi;
  ASSERT_TRUE(spi.start());
  EXPECT_TRUE(std::ranges::equal(spi.chip.loaded(), file));
  I2cRig i2c;
  ASSERT_TRUE(i2c.start());
  EXPECT_TRUE(std::ranges::equal(i2c.chip.loaded(), file));
}

TEST(Bmi270ConfigFile, MissingIsToldWithoutATransaction) {
  Rig rig;
  const std::vector<std::uint8_t> long_file(8194);
  const auto file = hal::sim::SimulatedBmi270::config_file();
  for (const auto wrong : {file.first(0), file.first(599), std::span{long_file}.first(8194)}) {
    give_file(rig, wrong);
    EXPECT_EQ(rig.driver.start(rig.clock.now()).error(),
              (DriverError{DriverErrorCode::no_config_file, {}, 0x5E}));
  }
  EXPECT_EQ(rig.faults.calls(), 0U);
}

TEST(Bmi270ConfigFile, ThatTheChipDoesNotTakeIsAFault) {
  Rig rig;
  const auto file = hal::sim::SimulatedBmi270::config_file();
  std::vector<std::uint8_t> damaged{file.begin(), file.end()};
  damaged[300] ^= 0x10U;
  give_file(rig, damaged);
  EXPECT_EQ(rig.start().error(), (DriverError{DriverErrorCode::sensor_fault, {}, 0x21}));
  give_file(rig, file);
  EXPECT_TRUE(rig.start());
}

TEST(Bmi270ConfigFile, TakesNoCallLongerThanAPortion) {
  Rig rig;
  std::size_t longest = 0;
  for (int ms = 0; ms < 180; ++ms) {
    const std::size_t before = rig.faults.calls();
    if (rig.driver.start(rig.clock.now())) break;
    longest = std::max(longest, rig.faults.calls() - before);
    rig.clock.advance(core::Duration::milliseconds(1));
  }
  EXPECT_EQ(longest, 13U) << "one for the identity, three for each burst of 64 bytes";
  EXPECT_TRUE(rig.chip.is_powered());
}

TEST(Bmi270, AnInterruptedSupplyGivesNoSample) {
  for (const auto& settings : {support::Bmi270::kDataReady, support::Bmi270::kFifo}) {
    Rig rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    rig.chip.cycle_power();
    std::array<GyroSample, 4> out{};
    EXPECT_EQ(rig.read(out).error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x21}));
    EXPECT_FALSE(rig.driver.verify_next());
    EXPECT_TRUE(rig.start());
  }
}

TEST(Bmi270Fifo, GivesNoShiftedSampleAfterLostBytes) {
  for (int lost = 1; lost < 6; ++lost) {
    Rig rig{{.mode = Mode::fifo}};
    ASSERT_TRUE(rig.start_and_settle());
    for (int i = 0; i < 3; ++i) rig.sample({deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)});
    for (int i = 0; i < lost; ++i) rig.chip.read_register(0x26);
    std::array<GyroSample, 8> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << lost;
    EXPECT_EQ(read.error().code, DriverErrorCode::fifo_overrun);
    rig.sample({deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)});
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_NEAR(out[0].rate[1].in(deg_per_s), 2.0F, 0.005F);
  }
}

}  // namespace
}  // namespace zerorate::drivers

/// @file
/// Particulars of the ICM-20948 and of its codec; the rest is in host_tests/contract.

#include "drivers/icm20948/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "host_tests/support/simulated_accelerometers.hpp"

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using icm20948::FullScale;
using icm20948::Mode;
using icm20948::OutputDataRate;
using Rig = support::GyroRig<support::OverSpi<support::Icm20948>>;
using I2cRig = support::GyroRig<support::OverI2c<support::Icm20948>>;
using AccelerationRig = support::GyroRig<support::OverSpi<support::Icm20948WithAcceleration>>;

TEST(Icm20948Lsb, IsTheFullScaleByTwoToThe15) {
  double dps = 250.0;
  for (const FullScale full_scale :
       {FullScale::dps_250, FullScale::dps_500, FullScale::dps_1000, FullScale::dps_2000}) {
    const double expected = dps / 32768.0 * std::numbers::pi / 180.0;
    EXPECT_NEAR(icm20948::lsb(full_scale).in(core::rad_per_s), expected,
                expected * 3.0 * std::exp2(-24));
    dps *= 2.0;
  }
}

TEST(Icm20948AccelerationLsb, IsTheRangeByTwoToThe15) {
  using enum icm20948::AccelerationRange;
  float g = 2.0F;
  for (const auto range : {g_2, g_4, g_8, g_16}) {
    EXPECT_FLOAT_EQ(icm20948::acceleration_lsb(range).in(core::standard_gravity), g / 32768.0F);
    g *= 2.0F;
  }
}

TEST(Icm20948Temperature, Is21DegreesAtZero) {
  EXPECT_EQ(icm20948::decode_temperature(0).degc(), 21.0F);
  EXPECT_NEAR(icm20948::decode_temperature(3339).degc(), 31.0F, 0.002F);
  EXPECT_NEAR(icm20948::decode_temperature(32767).degc(), 119.14F, 0.01F);
  EXPECT_NEAR(icm20948::decode_temperature(-32768).degc(), -77.15F, 0.01F);
}

TEST(Icm20948SamplePeriod, IsADividerOf1125Hz) {
  EXPECT_EQ(icm20948::sample_period(OutputDataRate::hz_12_5), core::Duration::milliseconds(80));
  EXPECT_EQ(icm20948::sample_period(OutputDataRate::hz_125), core::Duration::milliseconds(8));
  EXPECT_EQ(icm20948::sample_period(OutputDataRate::hz_1125), core::Duration::nanoseconds(888'889));
}

TEST(Icm20948Filter, EndsBelowHalfTheRate) {
  const std::array<double, 8> gyro_hz{196.6, 151.8, 119.5, 51.2, 23.9, 11.6, 5.7, 361.4};
  const std::array<double, 8> accelerometer_hz{246.0, 246.0, 111.4, 50.4, 23.9, 11.5, 5.7, 473.0};
  for (const auto& choice : icm20948::Chip::kRates) {
    const unsigned code = icm20948::encode_filter(choice.code);
    EXPECT_EQ(code & 0xC7U, 0x01U);
    EXPECT_LT(gyro_hz.at(code >> 3U), choice.value / 2.0);
    EXPECT_LT(accelerometer_hz.at(code >> 3U), choice.value / 2.0);
  }
}

TEST(Icm20948Filter, IsOneThatTheDividerWorksWith) {
  for (const auto& choice : icm20948::Chip::kRates) {
    if (choice.code == OutputDataRate::hz_1125) continue;  // not divided
    const unsigned code = icm20948::encode_filter(choice.code) >> 3U;
    EXPECT_GT(code, 0U) << choice.value;
    EXPECT_LT(code, 7U) << choice.value;
  }
}

TEST(Icm20948FifoLevel, KeepsRoomForThreeSamples) {
  EXPECT_EQ(icm20948::decode_fifo_level(0x00, 0x12).frames, 3);
  EXPECT_TRUE(icm20948::decode_fifo_level(0x00, 0x12).is_whole);
  EXPECT_FALSE(icm20948::decode_fifo_level(0x00, 0x12, 12).is_whole);
  EXPECT_FALSE(icm20948::decode_fifo_level(0x01, 0xEC).is_overrun) << "492 bytes";
  EXPECT_TRUE(icm20948::decode_fifo_level(0x01, 0xF2).is_overrun) << "498 bytes";
  EXPECT_TRUE(icm20948::decode_fifo_level(0x10, 0x00).is_plausible) << "a FIFO of 4096 bytes";
  EXPECT_FALSE(icm20948::decode_fifo_level(0x10, 0x01).is_plausible);
}

/// Register of bank 2.
template <class AnyRig>
std::uint8_t read_bank_2(AnyRig& rig, std::uint8_t address) {
  rig.chip.write_register(0x7F, 0x20);
  const std::uint8_t value = rig.chip.read_register(address);
  rig.chip.write_register(0x7F, 0x00);
  return value;
}

TEST(Icm20948, ConfiguresTheRegistersThatTheDatasheetNames) {
  AccelerationRig rig{
      {.full_scale = FullScale::dps_500, .rate = OutputDataRate::hz_225, .mode = Mode::fifo}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x03), 0x50);  // USER_CTRL: FIFO, SPI alone
  EXPECT_EQ(rig.chip.read_register(0x06), 0x01);  // PWR_MGMT_1: awake
  EXPECT_EQ(rig.chip.read_register(0x07), 0x00);  // PWR_MGMT_2: both on
  EXPECT_EQ(rig.chip.read_register(0x12), 0x1F);  // INT_ENABLE_2: overflow
  EXPECT_EQ(rig.chip.read_register(0x67), 0x1E);  // FIFO_EN_2: both
  EXPECT_EQ(rig.chip.read_register(0x69), 0x00);  // FIFO_MODE: stream
  EXPECT_EQ(read_bank_2(rig, 0x00), 4);           // GYRO_SMPLRT_DIV
  EXPECT_EQ(read_bank_2(rig, 0x01), 0x1B);        // GYRO_CONFIG_1: 51 Hz, 500 deg/s
  EXPECT_EQ(read_bank_2(rig, 0x09), 0x01);        // ODR_ALIGN_EN
  EXPECT_EQ(read_bank_2(rig, 0x11), 4);           // ACCEL_SMPLRT_DIV_2
  EXPECT_EQ(read_bank_2(rig, 0x14), 0x1B);        // ACCEL_CONFIG: 50 Hz, 4 g
  EXPECT_EQ(rig.chip.sample_period(), rig.driver.sample_period());
}

TEST(Icm20948, LeavesTheAccelerometerOffAndI2cOn) {
  I2cRig rig;
  ASSERT_TRUE(rig.start());
  EXPECT_FALSE(rig.chip.is_accelerometer_powered());
  EXPECT_EQ(rig.chip.read_register(0x07), 0x38);
  EXPECT_EQ(rig.chip.read_register(0x03), 0x00);
}

TEST(Icm20948Banks, AChipLeftInAnyBankIsFound) {
  for (const std::uint8_t bank : {std::uint8_t{0x10}, std::uint8_t{0x20}, std::uint8_t{0x30}}) {
    Rig rig;
    rig.chip.write_register(0x7F, bank);
    EXPECT_TRUE(rig.start());
    EXPECT_EQ(rig.chip.read_register(0x7F), 0x00);
  }
}

TEST(Icm20948Banks, NothingIsWrittenToAStranger) {
  Rig rig;
  rig.chip.upset(0x00, 0x01);
  const auto started = rig.start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, DriverErrorCode::wrong_identity);
  EXPECT_EQ(rig.faults.calls(), 2U) << "identity and bank are read";
}

TEST(Icm20948Banks, SamplesComeAfterASelectionThatFailed) {
  for (std::size_t call = 0; call < 3; ++call) {
    Rig rig;
    ASSERT_TRUE(rig.start_and_settle());
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(rig.driver.verify_next());
    rig.faults.inject({.kind = Fault::Kind::refused, .first = rig.faults.calls() + call});
    EXPECT_FALSE(rig.driver.verify_next()) << "a register of bank 2";
    rig.sample({deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)});
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(rig.read(out).value_or(0), 1U) << call;
    EXPECT_NEAR(out[0].rate[1].in(deg_per_s), 2.0F, 0.005F);
    EXPECT_EQ(rig.chip.read_register(0x7F), 0x00);
  }
}

TEST(Icm20948Banks, AnUpsetOfTheBankGivesNoSampleAndIsSeen) {
  for (const auto& settings : {support::Icm20948::kDataReady, support::Icm20948::kFifo}) {
    Rig rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)});
    rig.chip.upset(0x7F, 0x20);
    std::array<GyroSample, 4> out{};
    EXPECT_EQ(rig.read(out).value_or(0), 0U);
    EXPECT_FALSE(rig.driver.verify_next());
    EXPECT_TRUE(rig.start());
  }
}

TEST(Icm20948Fifo, GivesNoShiftedSampleAfterLostBytes) {
  for (int lost = 1; lost < 6; ++lost) {
    Rig rig{{.mode = Mode::fifo}};
    ASSERT_TRUE(rig.start_and_settle());
    for (int i = 0; i < 3; ++i) rig.sample({deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)});
    for (int i = 0; i < lost; ++i) rig.chip.read_register(0x72);
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

/// @file
/// Particulars of the BMI160 and of its codec; the rest is in host_tests/contract.

#include "drivers/bmi160/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "host_tests/support/simulated_accelerometers.hpp"

namespace zerorate::drivers {
namespace {

using bmi160::FullScale;
using bmi160::Mode;
using bmi160::OutputDataRate;
using core::deg_per_s;
using Rig = support::GyroRig<support::OverSpi<support::Bmi160>>;
using AccelerationRig = support::GyroRig<support::OverSpi<support::Bmi160WithAcceleration>>;

TEST(Bmi160Lsb, IsTheFullScaleByTwoToThe15) {
  double dps = 2000.0;
  for (const FullScale full_scale : {FullScale::dps_2000, FullScale::dps_1000, FullScale::dps_500,
                                     FullScale::dps_250, FullScale::dps_125}) {
    const double expected = dps / 32768.0 * std::numbers::pi / 180.0;
    EXPECT_NEAR(bmi160::lsb(full_scale).in(core::rad_per_s), expected,
                expected * 3.0 * std::exp2(-24));
    dps /= 2.0;
  }
}

TEST(Bmi160AccelerationLsb, IsTheRangeByTwoToThe15) {
  using enum bmi160::AccelerationRange;
  float g = 2.0F;
  for (const auto range : {g_2, g_4, g_8, g_16}) {
    EXPECT_FLOAT_EQ(bmi160::acceleration_lsb(range).in(core::standard_gravity), g / 32768.0F);
    g *= 2.0F;
  }
}

TEST(Bmi160Temperature, Is23DegreesAtZero) {
  EXPECT_EQ(bmi160::decode_temperature(0).degc(), 23.0F);
  EXPECT_EQ(bmi160::decode_temperature(512).degc(), 24.0F);
  EXPECT_EQ(bmi160::decode_temperature(32767).degc(), 87.0F - 1.0F / 512.0F);
  EXPECT_EQ(bmi160::decode_temperature(-32767).degc(), -41.0F + 1.0F / 512.0F);
}

TEST(Bmi160Status, IsPlausibleOnALiveLine) {
  EXPECT_TRUE(bmi160::is_plausible(0x10));
  EXPECT_TRUE(bmi160::is_plausible(0x11)) << "bit 0 is 1 after a reset";
  EXPECT_TRUE(bmi160::is_plausible(0xDA));
  EXPECT_FALSE(bmi160::is_plausible(0x00));
  EXPECT_FALSE(bmi160::is_plausible(0xFF));
}

TEST(Bmi160FifoLength, CountsFramesAndKeepsRoomForThree) {
  EXPECT_EQ(bmi160::decode_fifo_length(0x12, 0x00, 6).frames, 3);
  EXPECT_TRUE(bmi160::decode_fifo_length(0x12, 0x00, 6).is_whole);
  EXPECT_FALSE(bmi160::decode_fifo_length(0x12, 0x00, 12).is_whole);
  EXPECT_FALSE(bmi160::decode_fifo_length(0xEA, 0x03, 6).is_overrun) << "1002 bytes";
  EXPECT_TRUE(bmi160::decode_fifo_length(0xF0, 0x03, 6).is_overrun) << "1008 bytes";
  EXPECT_TRUE(bmi160::decode_fifo_length(0x00, 0x04, 6).is_plausible);
  EXPECT_FALSE(bmi160::decode_fifo_length(0x01, 0x04, 6).is_plausible);
}

TEST(Bmi160Watermark, LiesBetweenOneFrameLessAndTheFrames) {
  for (const unsigned bytes : {6U, 12U}) {
    for (unsigned frames = 1; frames <= 80; ++frames) {
      const unsigned level = 4U * bmi160::encode_watermark(frames, bytes);
      EXPECT_GT(level, bytes * (frames - 1));
      EXPECT_LE(level, bytes * frames);
    }
  }
}

TEST(Bmi160SamplePeriod, IsThatOfTheNamedRate) {
  EXPECT_EQ(bmi160::sample_period(OutputDataRate::hz_25), core::Duration::milliseconds(40));
  EXPECT_EQ(bmi160::sample_period(OutputDataRate::hz_100), core::Duration::milliseconds(10));
  EXPECT_EQ(bmi160::sample_period(OutputDataRate::hz_1600), core::Duration::microseconds(625));
}

TEST(Bmi160, ConfiguresTheRegistersThatTheDatasheetNames) {
  AccelerationRig rig{{.full_scale = FullScale::dps_500,
                       .rate = OutputDataRate::hz_200,
                       .mode = Mode::fifo,
                       .fifo_watermark = 10}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x03), 0x14);  // PMU_STATUS: both normal
  EXPECT_EQ(rig.chip.read_register(0x40), 0x29);  // ACC_CONF: 200 Hz
  EXPECT_EQ(rig.chip.read_register(0x41), 0x05);  // ACC_RANGE: 4 g
  EXPECT_EQ(rig.chip.read_register(0x42), 0x29);  // GYR_CONF: 200 Hz
  EXPECT_EQ(rig.chip.read_register(0x43), 0x02);  // GYR_RANGE: 500 deg/s
  EXPECT_EQ(rig.chip.read_register(0x46), 30);    // FIFO_CONFIG_0: 120 bytes
  EXPECT_EQ(rig.chip.read_register(0x47), 0xC0);  // FIFO_CONFIG_1: both, without headers
  EXPECT_EQ(rig.chip.read_register(0x51), 0x40);  // INT_EN_1: watermark
  EXPECT_EQ(rig.chip.read_register(0x53), 0x0A);  // INT_OUT_CTRL: INT1, push-pull, active high
  EXPECT_EQ(rig.chip.read_register(0x56), 0x40);  // INT_MAP_1: watermark
  EXPECT_EQ(rig.chip.sample_period(), rig.driver.sample_period());
}

TEST(Bmi160, LeavesTheAccelerometerSuspended) {
  Rig rig;
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x03), 0x04);
}

TEST(Bmi160, RefusesAGyroThatDoesNotWake) {
  Rig rig;
  (void)rig.driver.start(rig.clock.now());
  rig.clock.advance(core::Duration::milliseconds(10));
  (void)rig.driver.start(rig.clock.now());
  rig.chip.write_register(0x7E, 0x14);
  rig.clock.advance(core::Duration::milliseconds(85));
  EXPECT_EQ(rig.driver.start(rig.clock.now()).error(),
            (DriverError{DriverErrorCode::configuration_lost, {}, 0x03}));
  EXPECT_TRUE(rig.start());
}

TEST(Bmi160Fifo, GivesNoShiftedSampleAfterLostBytes) {
  for (int lost = 1; lost < 6; ++lost) {
    Rig rig{{.mode = Mode::fifo}};
    ASSERT_TRUE(rig.start_and_settle());
    for (int i = 0; i < 3; ++i) rig.sample({deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)});
    for (int i = 0; i < lost; ++i) rig.chip.read_register(0x24);
    std::array<GyroSample, 8> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << lost;
    EXPECT_EQ(read.error().code, DriverErrorCode::fifo_overrun);
    rig.sample({deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)});
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_NEAR(out[0].rate[1].in(deg_per_s), 2.0F, 0.005F);
  }
}

TEST(Bmi160DataReady, AnAccelerationThatIsNotNewIsNone) {
  AccelerationRig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample({});
  rig.chip.upset(0x1B, 0x80);  // drdy_acc
  std::array<GyroSample, 1> out{};
  ASSERT_EQ(rig.read(out).value_or(0), 1U);
  EXPECT_FALSE(out[0].has_acceleration);
  rig.sample({});
  ASSERT_EQ(rig.read(out).value_or(0), 1U);
  EXPECT_TRUE(out[0].has_acceleration);
}

}  // namespace
}  // namespace zerorate::drivers

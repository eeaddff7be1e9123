/// @file
/// Particulars of the accelerometer die of the BMI088; the rest is in host_tests/contract.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "drivers/bmi088/accelerometer.hpp"
#include "drivers/bmi088/codec.hpp"
#include "drivers/bmi088/driver.hpp"
#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_accelerometers.hpp"

namespace zerorate::drivers {
namespace {

using bmi088::AccelerationRange;
using bmi088::Mode;
using bmi088::OutputDataRate;
using bmi088::Settings;
using core::deg_per_s;
using core::standard_gravity;
using AccelerationRig = support::GyroRig<support::OverI2cTwice<support::Bmi088WithAcceleration>>;

TEST(Bmi088AccelerationLsb, IsTheFullScaleByTwoToThe15) {
  double full_scale_g = 3.0;
  for (int code = 0; code < 4; ++code, full_scale_g *= 2.0) {
    const double expected = full_scale_g / 32768.0 * 9.80665;
    const auto lsb = bmi088::acceleration_lsb(static_cast<AccelerationRange>(code));
    EXPECT_NEAR(lsb.in(core::m_per_s2), expected, expected * 2.0 * std::exp2(-24)) << code;
  }
}

TEST(Bmi088AccConf, HasTheRateNextToTheGyros) {
  EXPECT_EQ(bmi088::encode_acc_conf(OutputDataRate::hz_100_bandwidth_32), 0xA8);
  EXPECT_EQ(bmi088::encode_acc_conf(OutputDataRate::hz_100_bandwidth_12), 0xA8);
  EXPECT_EQ(bmi088::encode_acc_conf(OutputDataRate::hz_200_bandwidth_64), 0xA9);
  EXPECT_EQ(bmi088::encode_acc_conf(OutputDataRate::hz_400_bandwidth_47), 0xAA);
  EXPECT_EQ(bmi088::encode_acc_conf(OutputDataRate::hz_1000_bandwidth_116), 0xAB);
  EXPECT_EQ(bmi088::encode_acc_conf(OutputDataRate::hz_2000_bandwidth_532), 0xAC);
}

TEST(Bmi088AccFifoFrames, AreNoneWhereItIsEmptyOrCannotHoldThem) {
  EXPECT_EQ(bmi088::decode_acc_fifo_frames(0x00, 0x80), 0U) << "empty";
  EXPECT_EQ(bmi088::decode_acc_fifo_frames(0x07, 0x00), 1U);
  EXPECT_EQ(bmi088::decode_acc_fifo_frames(0x0D, 0x00), 1U);
  EXPECT_EQ(bmi088::decode_acc_fifo_frames(0xFE, 0x03), 146U);
  EXPECT_EQ(bmi088::decode_acc_fifo_frames(0xFF, 0xFF), 0U) << "a stuck line";
}

TEST(Bmi088AccelerationHeader, MayShowTheInterruptPins) {
  for (const std::uint8_t header : std::to_array<std::uint8_t>({0x84, 0x85, 0x86, 0x87})) {
    EXPECT_TRUE(bmi088::is_acceleration_header(header));
  }
  for (const std::uint8_t header :
       std::to_array<std::uint8_t>({0x00, 0x40, 0x44, 0x48, 0x50, 0x80, 0xFF})) {
    EXPECT_FALSE(bmi088::is_acceleration_header(header)) << int{header};
  }
}

TEST(Bmi088WithAcceleration, ConfiguresTheRegistersOfBothDies) {
  AccelerationRig rig{{.rate = OutputDataRate::hz_200_bandwidth_64}};
  ASSERT_TRUE(rig.start());
  auto& accelerometer = rig.chip.accelerometer();
  EXPECT_EQ(rig.chip.read_register(0x0F), 0x03);       // GYRO_RANGE: as without
  EXPECT_EQ(accelerometer.read_register(0x40), 0xA9);  // ACC_CONF: normal filter, 200 Hz
  EXPECT_EQ(accelerometer.read_register(0x41), 0x01);  // ACC_RANGE: 6 g
  EXPECT_EQ(accelerometer.read_register(0x48), 0x02);  // FIFO_CONFIG_0: stream
  EXPECT_EQ(accelerometer.read_register(0x49), 0x50);  // FIFO_CONFIG_1: acceleration
  EXPECT_EQ(accelerometer.read_register(0x7C), 0x00);  // ACC_PWR_CONF: active
  EXPECT_EQ(accelerometer.read_register(0x7D), 0x04);  // ACC_PWR_CTRL: on
}

TEST(Bmi088WithAcceleration, NeedsTheRightAccelerometer) {
  AccelerationRig rig;
  rig.chip.accelerometer().upset(0x00, 0x01);  // ACC_CHIP_ID
  EXPECT_EQ(rig.start().error(),
            (DriverError{DriverErrorCode::wrong_identity, {}, bmi088::kAccIdentityInErrors}));
}

TEST(Bmi088WithAcceleration, MeasuresInEveryRange) {
  for (const auto& range : bmi088::Chip::kAccelerationRanges) {
    AccelerationRig rig;
    using Wiring = support::OverI2cTwice<support::Bmi088WithAcceleration>;
    AccelerationRig::Driver driver{Wiring::link(rig.faults), Settings{}, range.code};
    for (int i = 0; i < 4; ++i) {
      (void)driver.start(rig.clock.now());
      rig.clock.advance(core::Duration::milliseconds(150));
    }
    const auto force_g = static_cast<float>(0.9 * range.value);
    rig.chip.set_specific_force({core::Acceleration{}, standard_gravity(-force_g), {}});
    rig.chip.measure({}, {});
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(driver.read(rig.clock.now(), out).value_or(0), 1U);
    ASSERT_TRUE(out[0].has_acceleration);
    EXPECT_NEAR(out[0].acceleration[1].in(standard_gravity), -force_g, 2e-5F * force_g);
    EXPECT_EQ(out[0].acceleration[0].in(core::m_per_s2), 0.0F);
  }
}

TEST(Bmi088WithAcceleration, OfAFasterDieLosesItsOldestFrames) {
  AccelerationRig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 5; ++i) {
    rig.chip.set_specific_force({standard_gravity(0.1F * static_cast<float>(i)), {}, {}});
    rig.sample({});
    if (i < 2) rig.chip.accelerometer().measure_force();
  }
  std::array<GyroSample, 8> out{};
  ASSERT_EQ(rig.read(out).value_or(0), 5U);
  for (const std::size_t i : {3U, 4U}) {
    ASSERT_TRUE(out.at(i).has_acceleration);
    EXPECT_NEAR(out.at(i).acceleration[0].in(standard_gravity), 0.1F * static_cast<float>(i),
                1e-3F);
  }
}

TEST(Bmi088WithAcceleration, OfASlowerDieIsSpreadOverTheSamples) {
  AccelerationRig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 20; ++i) {
    rig.chip.lose_accelerations(i % 5 == 4 ? 1 : 0);
    rig.chip.set_specific_force({standard_gravity(0.1F * static_cast<float>(i)), {}, {}});
    rig.sample({});
  }
  std::array<GyroSample, 32> out{};
  ASSERT_EQ(rig.read(out).value_or(0), 20U);
  int with = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    if (!out.at(i).has_acceleration) continue;
    ++with;
    const float age = out.at(i).acceleration[0].in(standard_gravity) / 0.1F - static_cast<float>(i);
    EXPECT_LE(std::abs(age), 1.01F) << i;
  }
  EXPECT_EQ(with, 16);
}

/// Another frame than one of acceleration: its length is another, and what follows is not known.
TEST(Bmi088WithAcceleration, GoesOnAfterAFrameWithAnotherHeader) {
  AccelerationRig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 3; ++i) rig.sample({deg_per_s(1.0F), {}, {}});
  // The gyro's level, the accelerometer's, the gyro's frames, and the accelerometer's.
  rig.faults.inject(
      {.kind = hal::testing::Fault::Kind::flipped_bit, .first = rig.faults.calls() + 3, .bit = 6});
  std::array<GyroSample, 8> out{};
  ASSERT_EQ(rig.read(out).value_or(0), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_FALSE(out.at(i).has_acceleration);
    EXPECT_NEAR(out.at(i).rate[0].in(deg_per_s), 1.0F, 0.005F);
  }
  rig.sample({deg_per_s(1.0F), {}, {}});
  ASSERT_EQ(rig.read(out).value_or(0), 1U);  // its frame went with the flush
  rig.sample({deg_per_s(1.0F), {}, {}});
  ASSERT_EQ(rig.read(out).value_or(0), 1U);
  EXPECT_TRUE(out[0].has_acceleration);
}

TEST(Bmi088WithAcceleration, OnSpiReadsTheIdentityTwice) {
  using hal::testing::reads;
  using hal::testing::writes;
  using GyroSpi = SpiRegisters<hal::testing::ScriptedSpiDevice>;
  using AccSpi = bmi088::AccelerometerSpi<hal::testing::ScriptedSpiDevice>;
  hal::testing::ScriptedSpiDevice gyro;
  hal::testing::ScriptedSpiDevice accelerometer;
  Bmi088<GyroSpi, AccSpi> driver{
      bmi088::Buses<GyroSpi, AccSpi>{GyroSpi{gyro}, AccSpi{accelerometer}}};
  gyro.expect({writes({0x80}), reads({0x0F})});
  accelerometer.expect({writes({0x80}), reads({0x00}), reads({0x00})});  // still on I2C
  accelerometer.expect({writes({0x80}), reads({0x00}), reads({0x1E})});
  accelerometer.expect({writes({0x7E, 0xB6})});
  gyro.expect({writes({0x14, 0xB6})});
  EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::not_ready);
}

}  // namespace
}  // namespace zerorate::drivers

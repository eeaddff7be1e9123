/// @file
/// Particulars of the accelerometer in the ICM-42688-P; the rest is in host_tests/contract.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "drivers/icm42688/codec.hpp"
#include "drivers/icm42688/driver.hpp"
#include "host_tests/support/simulated_accelerometers.hpp"

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using core::standard_gravity;
using hal::testing::Fault;
using icm42688::AccelerationRange;
using icm42688::Mode;
using icm42688::OutputDataRate;
using icm42688::Settings;
using AccelerationRig = support::GyroRig<support::OverSpi<support::Icm42688WithAcceleration>>;

TEST(Icm42688AccelerationLsb, IsTheFullScaleByTwoToThe15) {
  double full_scale_g = 16.0;
  for (int code = 0; code < 4; ++code, full_scale_g /= 2.0) {
    const double expected = full_scale_g / 32768.0 * 9.80665;
    const auto lsb = icm42688::acceleration_lsb(static_cast<AccelerationRange>(code));
    EXPECT_NEAR(lsb.in(core::m_per_s2), expected, expected * 2.0 * std::exp2(-24)) << code;
  }
}

TEST(Icm42688AccelConfig0, HoldsRangeAboveRate) {
  EXPECT_EQ(icm42688::encode_accel_config0(OutputDataRate::hz_100, AccelerationRange::g_4), 0x48);
  EXPECT_EQ(icm42688::encode_accel_config0(OutputDataRate::hz_1000, AccelerationRange::g_16), 0x06);
  EXPECT_EQ(icm42688::encode_accel_config0(OutputDataRate::hz_12_5, AccelerationRange::g_2), 0x6B);
}

TEST(Icm42688FifoHeader, IsThatOfBoth) {
  EXPECT_TRUE(is_header_of_both(0x60));
  EXPECT_TRUE(is_header_of_both(0x6B)) << "time stamp, first after a change of rate";
  EXPECT_FALSE(is_header_of_both(0x20)) << "gyro alone";
  EXPECT_FALSE(is_header_of_both(0x40)) << "accelerometer alone";
  EXPECT_FALSE(is_header_of_both(0x70)) << "20 bits";
  EXPECT_FALSE(is_header_of_both(0xE0)) << "empty";
}

TEST(Icm42688WithAcceleration, ConfiguresTheRegistersOfBoth) {
  AccelerationRig rig{{.mode = Mode::fifo, .fifo_watermark = 40}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x4E), 0x0F);  // PWR_MGMT0: both in low-noise mode
  EXPECT_EQ(rig.chip.read_register(0x4F), 0x68);  // GYRO_CONFIG0: as without
  EXPECT_EQ(rig.chip.read_register(0x50), 0x48);  // ACCEL_CONFIG0: 4 g, 100 Hz
  EXPECT_EQ(rig.chip.read_register(0x52), 0x00);  // GYRO_ACCEL_CONFIG0: half the rate, both
  EXPECT_EQ(rig.chip.read_register(0x5F), 0x27);  // FIFO_CONFIG1: accelerometer, gyro, temperature
  EXPECT_EQ(rig.chip.read_register(0x60), 0x80);  // FIFO_CONFIG2 and 3: 640 bytes
  EXPECT_EQ(rig.chip.read_register(0x61), 0x02);
}

TEST(Icm42688WithAcceleration, MeasuresInEveryRange) {
  for (const auto& range : icm42688::Chip::kAccelerationRanges) {
    AccelerationRig rig;
    AccelerationRig::Driver driver{SpiRegisters{rig.faults}, Settings{}, range.code};
    (void)driver.start(rig.clock.now());
    rig.clock.advance(core::Duration::milliseconds(1));
    ASSERT_TRUE(driver.start(rig.clock.now()));
    rig.clock.advance(core::Duration::seconds(1));
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

TEST(Icm42688WithAcceleration, AFlippedHeaderIsCorruptData) {
  for (std::size_t bit = 4; bit < 8; ++bit) {
    AccelerationRig rig{{.mode = Mode::fifo}};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({});
    rig.faults.inject(
        {.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls() + 2, .bit = bit});
    std::array<GyroSample, 4> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << bit;
    EXPECT_EQ(read.error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x30}));
  }
}

/// The chip makes the acceleration ready later than the rate.
TEST(Icm42688WithAcceleration, ThatChangesBetweenTheBurstsIsNone) {
  AccelerationRig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample({deg_per_s(5.0F), {}, {}});
  rig.faults.before(rig.faults.calls() + 1, [&] { rig.chip.upset(0x1F, 0x10); });
  std::array<GyroSample, 1> out{};
  ASSERT_EQ(rig.read(out).value_or(9), 1U);
  EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 5.0F, 0.005F);
  EXPECT_FALSE(out[0].has_acceleration);
  rig.sample({});
  ASSERT_EQ(rig.read(out).value_or(9), 1U);
  EXPECT_TRUE(out[0].has_acceleration);
}

TEST(Icm42688WithAcceleration, ThatTheChipCallsInvalidIsNone) {
  for (const auto mode : {Mode::data_ready, Mode::fifo}) {
    AccelerationRig rig{{.mode = mode}};
    ASSERT_TRUE(rig.start_and_settle());
    rig.chip.lose_accelerations(1);
    rig.sample({deg_per_s(5.0F), {}, {}});
    std::array<GyroSample, 2> out{};
    ASSERT_EQ(rig.read(out).value_or(9), 1U);
    EXPECT_FALSE(out[0].has_acceleration);
  }
}

}  // namespace
}  // namespace zerorate::drivers

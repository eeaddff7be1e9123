/// @file
/// Particulars of the accelerometer in the ICM-45686; the rest is in host_tests/contract.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "drivers/icm45686/codec.hpp"
#include "drivers/icm45686/driver.hpp"
#include "host_tests/support/simulated_accelerometers.hpp"

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using core::standard_gravity;
using icm45686::AccelerationRange;
using icm45686::Mode;
using icm45686::OutputDataRate;
using icm45686::Settings;
using AccelerationRig = support::GyroRig<support::OverSpi<support::Icm45686WithAcceleration>>;

TEST(Icm45686AccelerationLsb, IsTheFullScaleByTwoToThe15) {
  double full_scale_g = 16.0;
  for (int code = 1; code < 5; ++code, full_scale_g /= 2.0) {
    const double expected = full_scale_g / 32768.0 * 9.80665;
    const auto lsb = icm45686::acceleration_lsb(static_cast<AccelerationRange>(code));
    EXPECT_NEAR(lsb.in(core::m_per_s2), expected, expected * 2.0 * std::exp2(-24)) << code;
  }
}

TEST(Icm45686AccelConfig0, HoldsRangeAboveRate) {
  EXPECT_EQ(icm45686::encode_accel_config0(OutputDataRate::hz_100, AccelerationRange::g_4), 0x39);
  EXPECT_EQ(icm45686::encode_accel_config0(OutputDataRate::hz_1600, AccelerationRange::g_16), 0x15);
  EXPECT_EQ(icm45686::encode_accel_config0(OutputDataRate::hz_12_5, AccelerationRange::g_2), 0x4C);
}

TEST(Icm45686WithAcceleration, ConfiguresTheRegistersOfBoth) {
  AccelerationRig rig{{.mode = Mode::fifo, .fifo_watermark = 40}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x10), 0x0F);  // PWR_MGMT0: both in low-noise mode
  EXPECT_EQ(rig.chip.read_register(0x1B), 0x39);  // ACCEL_CONFIG0: 4 g, 100 Hz
  EXPECT_EQ(rig.chip.read_register(0x1C), 0x49);  // GYRO_CONFIG0: as without
  EXPECT_EQ(rig.chip.read_register(0x1E), 0x28);  // FIFO_CONFIG1: 40 packets
  EXPECT_EQ(rig.chip.read_register(0x21), 0x07);  // FIFO_CONFIG3: open, gyro, accelerometer
  EXPECT_EQ(rig.chip.read_register(0x22), 0x02);  // FIFO_CONFIG4: time
}

TEST(Icm45686WithAcceleration, MeasuresInEveryRange) {
  for (const auto& range : icm45686::Chip::kAccelerationRanges) {
    AccelerationRig rig;
    AccelerationRig::Driver driver{SpiRegisters{rig.faults}, Settings{}, range.code};
    auto started = driver.start(rig.clock.now());
    for (int ms = 0; ms < 5 && !started; ++ms) {
      rig.clock.advance(core::Duration::milliseconds(1));
      started = driver.start(rig.clock.now());
    }
    ASSERT_TRUE(started);
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

TEST(Icm45686WithAcceleration, ThatTheChipCallsInvalidIsNone) {
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

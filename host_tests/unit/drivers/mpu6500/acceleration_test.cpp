/// @file
/// Particulars of the accelerometer in the MPU-6500 and its relatives; the rest is in
/// host_tests/contract.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "drivers/mpu6500/codec.hpp"
#include "drivers/mpu6500/driver.hpp"
#include "host_tests/support/simulated_accelerometers.hpp"

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using core::standard_gravity;
using mpu6500::AccelerationRange;
using mpu6500::Mode;
using mpu6500::OutputDataRate;
using mpu6500::Settings;
using AccelerationRig = support::GyroRig<support::OverSpi<support::Mpu6500WithAcceleration>>;
using OldRig = support::GyroRig<support::OverI2c<support::Mpu6050WithAcceleration>>;

constexpr Settings kBatched{.mode = Mode::fifo};
constexpr support::Rates kRates{deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)};

TEST(Mpu6500AccelerationLsb, AgreesWithTheDataSheet) {
  // PS-MPU-6000A-00, 6.2: LSB/g by AFS_SEL.
  constexpr std::array kLsbPerG{16384.0, 8192.0, 4096.0, 2048.0};
  for (std::size_t code = 0; code < kLsbPerG.size(); ++code) {
    const double expected = 9.80665 / kLsbPerG.at(code);
    const auto lsb = mpu6500::acceleration_lsb(static_cast<AccelerationRange>(code << 3U));
    EXPECT_NEAR(lsb.in(core::m_per_s2), expected, expected * 2.0 * std::exp2(-24));
  }
}

TEST(Mpu6500FifoLevel, CountsSamplesOfTwelveBytes) {
  const mpu6500::Variant& chip = *mpu6500::find_variant(0x70);
  EXPECT_EQ(mpu6500::decode_fifo_level(chip, 0x00, 0x24, 12).frames, 3);
  EXPECT_TRUE(mpu6500::decode_fifo_level(chip, 0x00, 0x24, 12).is_whole);
  EXPECT_FALSE(mpu6500::decode_fifo_level(chip, 0x00, 0x2A, 12).is_whole);
  EXPECT_FALSE(mpu6500::decode_fifo_level(chip, 0x01, 0xD4, 12).is_overrun) << "468 bytes";
  EXPECT_TRUE(mpu6500::decode_fifo_level(chip, 0x01, 0xE0, 12).is_overrun) << "480 bytes";
}

TEST(Mpu6500WithAcceleration, ConfiguresTheRegistersOfBoth) {
  AccelerationRig rig{{.rate = OutputDataRate::hz_200, .mode = Mode::fifo}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x1A), 0x02);  // CONFIG: as without
  EXPECT_EQ(rig.chip.read_register(0x1C), 0x08);  // ACCEL_CONFIG: 4 g
  EXPECT_EQ(rig.chip.read_register(0x1D), 0x02);  // ACCEL_CONFIG_2: the filter of the gyro
  EXPECT_EQ(rig.chip.read_register(0x23), 0x78);  // FIFO_EN: accelerometer and gyro
  EXPECT_EQ(rig.chip.read_register(0x6C), 0x00);  // PWR_MGMT_2: all on
}

/// RM-MPU-6000A-00 does not list the register.
TEST(Mpu6050WithAcceleration, HasNoSecondRegister) {
  OldRig rig;
  rig.chip.upset(0x1D, 0x55);
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x1C), 0x08);
  EXPECT_EQ(rig.chip.read_register(0x1D), 0x00) << "as after the reset";
}

TEST(Mpu6500WithAcceleration, MeasuresInEveryRange) {
  for (const auto& range : mpu6500::Chip::kAccelerationRanges) {
    AccelerationRig rig;
    AccelerationRig::Driver driver{SpiRegisters{rig.faults}, Settings{}, range.code};
    for (int i = 0; i < 3; ++i) {
      (void)driver.start(rig.clock.now());
      rig.clock.advance(core::Duration::milliseconds(110));
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

/// Six bytes are an accelerometer's or a gyro's: without a look at the level they would change
/// places.
TEST(Mpu6500WithAcceleration, GivesNoShiftedSampleAfterLostBytes) {
  for (std::size_t lost = 1; lost < 12; ++lost) {
    AccelerationRig rig{kBatched};
    ASSERT_TRUE(rig.start_and_settle());
    rig.chip.set_specific_force({standard_gravity(0.5F), {}, standard_gravity(1.0F)});
    for (int i = 0; i < 5; ++i) rig.sample(kRates);
    std::array<std::uint8_t, 12> bytes{};
    SpiRegisters registers{rig.bus};
    ASSERT_TRUE(registers.read(0x74, std::span{bytes}.first(lost)));
    std::size_t given = 0;
    for (int i = 0; i < 10; ++i) {
      rig.sample(kRates);
      std::array<GyroSample, 16> out{};
      const std::size_t count = rig.read(out).value_or(0);
      for (std::size_t k = 0; k < count; ++k) {
        EXPECT_NEAR(out.at(k).rate[2].in(deg_per_s), 3.0F, 0.005F);
        EXPECT_NEAR(out.at(k).acceleration[0].in(standard_gravity), 0.5F, 1e-4F);
        EXPECT_NEAR(out.at(k).acceleration[2].in(standard_gravity), 1.0F, 1e-4F);
      }
      given += count;
    }
    EXPECT_GE(given, 9U) << lost;
  }
}

}  // namespace
}  // namespace zerorate::drivers

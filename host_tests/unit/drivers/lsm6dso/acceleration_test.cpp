/// @file
/// Particulars of the accelerometer in the LSM6DSO and its relatives; the rest is in
/// host_tests/contract.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "drivers/lsm6dso/codec.hpp"
#include "drivers/lsm6dso/driver.hpp"
#include "drivers/lsm6dso/slots.hpp"
#include "host_tests/support/simulated_accelerometers.hpp"

namespace zerorate::drivers::lsm6dso {
namespace {

TEST(AccelerationLsb, IsTheSensitivityOfTheDatasheet) {
  constexpr std::array kMgPerLsb{0.061, 0.122, 0.244, 0.488};  // DS12140, table 2
  for (std::size_t code = 0; code < kMgPerLsb.size(); ++code) {
    const double expected = kMgPerLsb.at(code) * 1e-3 * 9.80665;
    EXPECT_NEAR(acceleration_lsb(static_cast<AccelerationRange>(code)).in(core::m_per_s2), expected,
                expected * 3.0 * std::exp2(-24));
  }
}

TEST(Ctrl1Xl, HoldsRateAboveRange) {
  const std::uint8_t rate = static_cast<std::uint8_t>(OutputDataRate::hz_104);
  EXPECT_EQ(encode_ctrl1_xl(rate, AccelerationRange::g_2), 0x40);
  EXPECT_EQ(encode_ctrl1_xl(rate, AccelerationRange::g_4), 0x48);
  EXPECT_EQ(encode_ctrl1_xl(rate, AccelerationRange::g_8), 0x4C);
  EXPECT_EQ(encode_ctrl1_xl(rate, AccelerationRange::g_16), 0x44);
}

class SlotsTest : public ::testing::Test {
 protected:
  static GyroSample gyro(std::int64_t time_ns) {
    GyroSample sample;
    sample.time = core::Instant::from_ns(time_ns);
    return sample;
  }
  bool add_gyro(std::uint8_t slot, std::int64_t time_ns) {
    return slots_.add_gyro(slot, gyro(time_ns), out_);
  }
  bool add_acceleration(std::uint8_t slot, std::int16_t raw) {
    return slots_.add_acceleration(slot, {raw, raw, raw}, out_);
  }
  void expect_sample(std::int64_t time_ns, bool has_acceleration, float m_s2 = 0.0F) const {
    EXPECT_EQ(out_.time.ns(), time_ns);
    EXPECT_EQ(out_.has_acceleration, has_acceleration);
    EXPECT_EQ(out_.acceleration[1].in(core::m_per_s2), m_s2);
  }

  Slots slots_{AccelerationScale{.lsb = core::m_per_s2(1.0F)}};
  GyroSample out_;
};

TEST_F(SlotsTest, JoinTheWordsOfASlotInEitherOrder) {
  EXPECT_FALSE(add_gyro(0, 1));
  EXPECT_TRUE(add_acceleration(0, 11));
  expect_sample(1, true, 11.0F);
  EXPECT_FALSE(add_acceleration(1, 12));
  EXPECT_TRUE(add_gyro(1, 2));
  expect_sample(2, true, 12.0F);
}

TEST_F(SlotsTest, GiveTheGyroAloneWhereItsPartnerIsLost) {
  EXPECT_FALSE(add_gyro(0, 1));
  EXPECT_TRUE(add_gyro(1, 2));
  expect_sample(1, false);
  EXPECT_TRUE(add_acceleration(2, 13));
  expect_sample(2, false);
  EXPECT_TRUE(add_gyro(2, 3));
  expect_sample(3, true, 13.0F);
}

TEST_F(SlotsTest, ForgetAnAccelerationWhoseGyroIsLost) {
  EXPECT_FALSE(add_acceleration(0, 11));
  EXPECT_FALSE(add_gyro(1, 2));
  EXPECT_TRUE(add_acceleration(1, 12));
  expect_sample(2, true, 12.0F);
  EXPECT_FALSE(add_gyro(2, 3));
  slots_.restart();
  EXPECT_FALSE(add_acceleration(2, 13)) << "its gyro was forgotten";
}

}  // namespace
}  // namespace zerorate::drivers::lsm6dso

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using lsm6dso::Mode;
using lsm6dso::Settings;

constexpr Settings kBatched{.mode = Mode::fifo};

using AccelerationRig = support::GyroRig<support::OverSpi<support::Lsm6dsoWithAcceleration>>;

TEST(Lsm6dsoWithAcceleration, ConfiguresTheRegistersOfBoth) {
  AccelerationRig rig{{.mode = Mode::fifo, .fifo_watermark = 200}};
  rig.chip.upset(0x15, 0x10);  // CTRL6_C: low-power mode of the accelerometer
  rig.chip.upset(0x17, 0x06);  // CTRL8_XL: high-pass filter, XL_FS_MODE
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x10), 0x48);  // CTRL1_XL: 104 Hz, 4 g
  EXPECT_EQ(rig.chip.read_register(0x11), 0x40);  // CTRL2_G: as without
  EXPECT_EQ(rig.chip.read_register(0x15), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x17), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x07), 0x90);  // FIFO_CTRL1, 2: 400 words
  EXPECT_EQ(rig.chip.read_register(0x08), 0x01);
  EXPECT_EQ(rig.chip.read_register(0x09), 0x44);  // FIFO_CTRL3: both at 104 Hz
}

TEST(Lsm6dsoWithAcceleration, OfTheLsm6dsv16xHasItsRangeInCtrl8) {
  support::GyroRig<support::OverSpi<support::Lsm6dsv16xWithAcceleration>> rig{
      {.rate = lsm6dso::DsvRate::hz_240, .mode = Mode::fifo, .fifo_watermark = 127}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x10), 0x07);  // CTRL1: high performance, 240 Hz
  EXPECT_EQ(rig.chip.read_register(0x17), 0x01);  // CTRL8: 4 g
  EXPECT_EQ(rig.chip.read_register(0x07), 0xFE);  // FIFO_CTRL1: 254 words
  EXPECT_EQ(rig.chip.read_register(0x08), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x09), 0x77);
}

TEST(Lsm6dsoWithAcceleration, MeasuresInEveryRange) {
  for (const auto& range : lsm6dso::Chip::kAccelerationRanges) {
    AccelerationRig rig;
    AccelerationRig::Driver driver{SpiRegisters{rig.faults}, Settings{}, range.code};
    (void)driver.start(rig.clock.now());
    rig.clock.advance(core::Duration::milliseconds(1));
    ASSERT_TRUE(driver.start(rig.clock.now()));
    rig.clock.advance(core::Duration::seconds(6));
    const auto force_g = static_cast<float>(0.9 * range.value);
    rig.chip.set_specific_force({core::Acceleration{}, core::standard_gravity(-force_g), {}});
    rig.chip.measure({}, {});
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(driver.read(rig.clock.now(), out).value_or(0), 1U);
    ASSERT_TRUE(out[0].has_acceleration);
    EXPECT_NEAR(out[0].acceleration[1].in(core::standard_gravity), -force_g, 2e-5F * force_g);
    EXPECT_EQ(out[0].acceleration[0].in(core::m_per_s2), 0.0F);
  }
}

/// The oldest words are lost one by one: what is left may begin with the accelerometer's.
TEST(Lsm6dsoWithAcceleration, GoesOnAfterAnOverrunWithinASlot) {
  AccelerationRig rig{kBatched};
  ASSERT_TRUE(rig.start_and_settle());
  rig.chip.lose_accelerations(1);
  for (int i = 0; i < 260; ++i) rig.sample({deg_per_s(0.1F * static_cast<float>(i)), {}, {}});
  std::array<GyroSample, 600> out{};
  const auto overrun = rig.read(out);
  ASSERT_FALSE(overrun);
  EXPECT_EQ(overrun.error().code, DriverErrorCode::fifo_overrun);
  ASSERT_EQ(rig.read(out).value_or(0), 256U);
  for (std::size_t i = 0; i < 256; ++i) {
    EXPECT_NEAR(out.at(i).rate[0].in(deg_per_s), 0.1F * static_cast<float>(i + 4), 0.005F);
    EXPECT_TRUE(out.at(i).has_acceleration);
  }
  EXPECT_EQ(out[255].time, rig.clock.now());
}

TEST(Lsm6dsoWithAcceleration, DropsTheWordBesideALostOne) {
  AccelerationRig rig{kBatched};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 4; ++i) rig.sample({deg_per_s(static_cast<float>(i)), {}, {}});
  std::array<std::uint8_t, 7> word{};
  SpiRegisters registers{rig.bus};
  ASSERT_TRUE(registers.read(0x78, word));  // somebody else took the first gyro's word
  std::array<GyroSample, 8> out{};
  ASSERT_EQ(rig.read(out).value_or(0), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(out.at(i).rate[0].in(deg_per_s), static_cast<float>(i + 1), 0.005F);
    EXPECT_TRUE(out.at(i).has_acceleration);
    EXPECT_LE(out.at(i).time, rig.clock.now());
  }
}

TEST(Lsm6dsoWithAcceleration, AFlippedTagIsCorruptData) {
  for (std::size_t bit = 0; bit < 8; ++bit) {
    AccelerationRig rig{kBatched};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({});
    constexpr std::size_t kSecondWord = 56;  // bits
    rig.faults.inject({.kind = Fault::Kind::flipped_bit,
                       .first = rig.faults.calls() + 2,
                       .bit = kSecondWord + bit});
    std::array<GyroSample, 4> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << bit;
    EXPECT_EQ(read.error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x78}));
  }
}

struct Lsm6dslWithAcceleration : support::WithAcceleration<support::Lsm6dsl, lsm6dso::Lsm6dsl> {};

TEST(Lsm6dslAcceleration, ComesWithTheSampleAtDataReady) {
  support::GyroRig<support::OverSpi<Lsm6dslWithAcceleration>> rig;
  ASSERT_TRUE(rig.start_and_settle());
  EXPECT_EQ(rig.chip.read_register(0x10), 0x48);  // CTRL1_XL: 104 Hz, 4 g
  EXPECT_EQ(rig.chip.read_register(0x09), 0x00);  // FIFO_CTRL4
  rig.sample({core::deg_per_s(10.0F), {}, {}});
  std::array<GyroSample, 1> out{};
  ASSERT_EQ(rig.read(out).value_or(0), 1U);
  ASSERT_TRUE(out[0].has_acceleration);
  EXPECT_NEAR(out[0].acceleration[2].in(core::m_per_s2), 9.80665F, 0.001F);
  EXPECT_NEAR(out[0].rate[0].in(core::deg_per_s), 10.0F, 0.005F);
}

}  // namespace
}  // namespace zerorate::drivers

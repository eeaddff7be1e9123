/// @file
/// Particulars of the BMI088 and of its codec; the rest is in host_tests/contract.

#include "drivers/bmi088/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "drivers/bmi088/codec.hpp"
#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::drivers::bmi088 {
namespace {

TEST(Bmi088Lsb, IsTheSensitivityOfTheDatasheet) {
  constexpr std::array kLsbPerDps{16.384, 32.768, 65.536, 131.072, 262.144};
  for (std::size_t code = 0; code < kLsbPerDps.size(); ++code) {
    const double expected = 1.0 / kLsbPerDps[code];
    const double got = lsb(static_cast<FullScale>(code)).in(core::deg_per_s);
    // Roundings of pi / 180, of the product, and of both again on the way back.
    EXPECT_NEAR(got, expected, expected * 4.0 * std::exp2(-24)) << code;
  }
}

TEST(Bmi088FifoStatus, HoldsLevelAndOverrun) {
  EXPECT_EQ(decode_fifo_status(0x00).frames, 0);
  EXPECT_EQ(decode_fifo_status(0x64).frames, 100);
  EXPECT_FALSE(decode_fifo_status(0x64).is_overrun);
  EXPECT_TRUE(decode_fifo_status(0x64).is_plausible);
  EXPECT_EQ(decode_fifo_status(0xE4).frames, 100);
  EXPECT_TRUE(decode_fifo_status(0xE4).is_overrun);
  EXPECT_FALSE(decode_fifo_status(0x65).is_plausible);
  EXPECT_FALSE(decode_fifo_status(0xFF).is_plausible);
}

TEST(Bmi088SamplePeriod, IsThatOfTheNamedRate) {
  using enum OutputDataRate;
  EXPECT_EQ(sample_period(hz_2000_bandwidth_532), core::Duration::microseconds(500));
  EXPECT_EQ(sample_period(hz_2000_bandwidth_230), core::Duration::microseconds(500));
  EXPECT_EQ(sample_period(hz_1000_bandwidth_116), core::Duration::milliseconds(1));
  EXPECT_EQ(sample_period(hz_400_bandwidth_47), core::Duration::microseconds(2500));
  EXPECT_EQ(sample_period(hz_200_bandwidth_23), core::Duration::milliseconds(5));
  EXPECT_EQ(sample_period(hz_200_bandwidth_64), core::Duration::milliseconds(5));
  EXPECT_EQ(sample_period(hz_100_bandwidth_12), core::Duration::milliseconds(10));
  EXPECT_EQ(sample_period(hz_100_bandwidth_32), core::Duration::milliseconds(10));
}

}  // namespace
}  // namespace zerorate::drivers::bmi088

namespace zerorate::drivers {
namespace {

using bmi088::Mode;
using core::deg_per_s;
using hal::testing::Fault;
using Rig = support::GyroRig<support::OverSpi<support::Bmi088>>;

TEST(Bmi088, ConfiguresTheRegistersThatTheDatasheetNames) {
  Rig rig{{.mode = Mode::fifo, .fifo_watermark = 40}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x0F), 0x03);  // GYRO_RANGE: 250 deg/s
  EXPECT_EQ(rig.chip.read_register(0x10), 0x87);  // GYRO_BANDWIDTH: 100 Hz, 32 Hz
  EXPECT_EQ(rig.chip.read_register(0x11), 0x00);  // GYRO_LPM1: normal mode
  EXPECT_EQ(rig.chip.read_register(0x15), 0x40);  // GYRO_INT_CTRL: FIFO
  EXPECT_EQ(rig.chip.read_register(0x16), 0x0D);  // INT3 push-pull, active high; INT4 as it was
  EXPECT_EQ(rig.chip.read_register(0x18), 0x04);  // INT3 carries the FIFO's interrupt
  EXPECT_EQ(rig.chip.read_register(0x1E), 0x88);  // FIFO_WM_ENABLE
  EXPECT_EQ(rig.chip.read_register(0x3D), 0x27);  // FIFO_CONFIG_0: more than 39 frames
  EXPECT_EQ(rig.chip.read_register(0x3E), 0x40);  // FIFO_CONFIG_1: stop on full
}

TEST(Bmi088DataReady, GivesWhatALateLoopMissed) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 1; i <= 3; ++i) rig.sample({deg_per_s(static_cast<float>(i)), {}, {}});
  const auto edge = rig.chip.interrupt().take_edge();
  ASSERT_TRUE(edge);
  rig.clock.advance(core::Duration::milliseconds(2));
  std::array<GyroSample, 4> out{};
  ASSERT_EQ(rig.driver.read(*edge, out).value_or(0), 3U);
  EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 1.0F, 0.005F);
  EXPECT_EQ(out[2].time, *edge);
  EXPECT_EQ(out[1].time, *edge - rig.driver.sample_period());
}

TEST(Bmi088DataReady, StampsEachSampleWithItsEdge) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  std::array<GyroSample, 1> out{};
  for (int i = 0; i < 100; ++i) {
    rig.clock.advance(rig.driver.sample_period() * (i % 2 == 0 ? 97 : 103) / 100);
    rig.chip.measure({}, {});
    ASSERT_EQ(rig.driver.read(*rig.chip.interrupt().take_edge(), out).value_or(0), 1U);
    EXPECT_EQ(out[0].time, rig.clock.now());
  }
}

TEST(Bmi088Fifo, DropsWhatItHeldWhenItOverran) {
  Rig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 101; ++i) rig.sample({});
  std::array<GyroSample, 200> out{};
  EXPECT_EQ(rig.read(out).error().code, DriverErrorCode::fifo_overrun);
  EXPECT_EQ(rig.read(out).value_or(9), 0U);
  rig.sample({});
  EXPECT_EQ(rig.read(out).value_or(9), 1U);
}

TEST(Bmi088Fifo, FilledToTheBrimIsNotAnOverrun) {
  Rig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 100; ++i) rig.sample({});
  std::array<GyroSample, 200> out{};
  EXPECT_EQ(rig.read(out).value_or(0), 100U);
}

TEST(Bmi088Fifo, IsClearedAfterABurstThatBrokeOff) {
  // Else the rest of the frame that was read in part would be taken for the next frame's beginning.
  Rig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 5; ++i) rig.sample({deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)});
  const std::size_t before = rig.faults.calls();
  rig.faults.inject({.kind = Fault::Kind::refused, .first = before + 1});
  std::array<GyroSample, 16> out{};
  ASSERT_FALSE(rig.read(out));
  EXPECT_EQ(rig.faults.calls() - before, 3U);  // the level, the burst, and the clearing
  EXPECT_EQ(rig.chip.read_register(0x0E), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x3E), 0x40);
}

TEST(Bmi088OnScriptedSpi, ReadsWithoutADummyByte) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedSpiDevice spi;
  spi.expect({writes({0x80}), reads({0x0F})});
  spi.expect({writes({0x14, 0xB6})});
  Bmi088 driver{SpiRegisters{spi}};
  EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::not_ready);
}

}  // namespace
}  // namespace zerorate::drivers

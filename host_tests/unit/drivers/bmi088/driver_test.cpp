/// @file
/// Particulars of the BMI088; the rest is in host_tests/contract.

#include "drivers/bmi088/driver.hpp"

#include <gtest/gtest.h>

#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_gyros.hpp"

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
  EXPECT_EQ(rig.chip.read_register(0x3D), 0x28);  // FIFO_CONFIG_0: 40 frames
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

TEST(Bmi088DataReady, StampsEachSampleWithItsEdgeHoweverFastTheChip) {
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

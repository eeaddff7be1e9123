/// @file
/// Particulars of the LSM6DSO; the rest is in host_tests/contract.

#include "drivers/lsm6dso/driver.hpp"

#include <gtest/gtest.h>

#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using lsm6dso::Mode;
using lsm6dso::Settings;
using Rig = support::GyroRig<support::OverSpi<support::Lsm6dso>>;

constexpr Settings kFifo{.mode = Mode::fifo};

TEST(Lsm6dso, ConfiguresTheRegistersThatTheDatasheetNames) {
  Rig rig;
  rig.chip.upset(0x16, 0xC0);  // CTRL7_G: low-power mode and high-pass filter
  rig.chip.upset(0x13, 0x42);  // CTRL4_C: sleep, LPF1
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x16), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x13), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x12), 0x44);  // CTRL3_C: BDU, IF_INC
  EXPECT_EQ(rig.chip.read_register(0x11), 0x40);  // CTRL2_G: 104 Hz, 250 deg/s
  EXPECT_EQ(rig.chip.read_register(0x18), 0xE2);  // CTRL9_XL: reset value and I3C_disable
}

TEST(Lsm6dso, ReportsARegisterThatDoesNotTakeItsValue) {
  // Identity, reset, identity, CTRL3_C; then the first entry: read, write and read back.
  Rig rig;
  rig.faults.inject({.kind = Fault::Kind::flipped_bit, .first = 6, .bit = 6});  // BDU
  const auto started = rig.start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error(), (DriverError{DriverErrorCode::configuration_lost, {}, 0x12}));
}

TEST(Lsm6dso, ReadsItsOwnPeriod) {
  Rig rig{{}, {}, std::int8_t{20}};  // 3 % fast
  EXPECT_NEAR(rig.driver.sample_period().in_seconds(), 64.0F / 6667.0F, 1e-8F);
  ASSERT_TRUE(rig.start());
  EXPECT_NEAR(rig.driver.sample_period().in_seconds(), 64.0F / 6667.0F / 1.03F, 1e-8F);
}

TEST(Lsm6dso, GivesNoSampleFromALineThatGotStuckBetweenStatusAndData) {
  for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
    Rig rig;
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({deg_per_s(1.0F), {}, {}});
    rig.faults.inject({.kind = kind, .first = rig.faults.calls() + 1});
    std::array<GyroSample, 4> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x1E}));
  }
}

TEST(Lsm6dsoFifo, GoesOnWithTheOldestThatIsLeftAfterAnOverrun) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  constexpr int kLost = 7;
  for (int i = 0; i < 512 + kLost; ++i) {
    rig.sample({deg_per_s(0.1F * static_cast<float>(i)), {}, {}});
  }
  std::array<GyroSample, 600> out{};
  const auto overrun = rig.read(out);
  ASSERT_FALSE(overrun);
  EXPECT_EQ(overrun.error().code, DriverErrorCode::fifo_overrun);
  ASSERT_EQ(rig.read(out).value_or(0), 512U);
  EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 0.1F * kLost, 0.005F);
  EXPECT_EQ(out[511].time, rig.clock.now());
}

TEST(Lsm6dsoFifo, FilledToTheBrimIsNotAnOverrun) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 512; ++i) rig.sample({});
  std::array<GyroSample, 600> out{};
  EXPECT_EQ(rig.read(out).value_or(0), 512U);
}

TEST(Lsm6dsoFifo, AFlippedTagIsCorruptData) {
  for (std::size_t bit = 0; bit < 8; ++bit) {
    Rig rig{kFifo};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({});
    rig.faults.inject(
        {.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls() + 2, .bit = bit});
    std::array<GyroSample, 4> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << bit;
    EXPECT_EQ(read.error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x78}));
  }
}

TEST(Lsm6dsoOnScriptedSpi, AsksForTheIdentityAndResetsTheChip) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedSpiDevice spi;
  spi.expect({writes({0x8F}), reads({0x6C})});
  spi.expect({writes({0x12, 0x05})});
  Lsm6dso driver{SpiRegisters{spi}};
  EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::not_ready);
}

TEST(Lsm6dsoOnScriptedI2c, ReportsAFailureInTheMiddleOfATransaction) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedI2cBus i2c;
  i2c.expect(lsm6dso::kAddressSa0High, {writes({0x0F}), reads({0x6C})},
             hal::testing::FailureAt{1, hal::BusError::arbitration_lost});
  Lsm6dso driver{I2cRegisters{i2c, lsm6dso::kAddressSa0High}};
  EXPECT_EQ(driver.start({}).error(),
            (DriverError{DriverErrorCode::bus_failed, hal::BusError::arbitration_lost, 0x0F}));
}

}  // namespace
}  // namespace zerorate::drivers

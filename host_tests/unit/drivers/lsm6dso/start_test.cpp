/// @file
/// Identity, reset, configuration and its re-verification, over both buses.

#include <gtest/gtest.h>

#include <vector>

#include "hal/testing/scripted_bus.hpp"
#include "host_tests/unit/drivers/lsm6dso/rig.hpp"

namespace zerorate::drivers {
namespace {

using hal::testing::Fault;
using lsm6dso::Mode;

template <class Wiring>
class Lsm6dsoStart : public ::testing::Test {};
using Wirings = ::testing::Types<OverSpi, OverI2c>;
TYPED_TEST_SUITE(Lsm6dsoStart, Wirings);

template <class Wiring>
class Lsm6dsoRunning : public ::testing::Test {};
TYPED_TEST_SUITE(Lsm6dsoRunning, Wirings);

TYPED_TEST(Lsm6dsoStart, NeedsTheResetTimeAndThenSucceeds) {
  Rig<TypeParam> rig;
  const auto first = rig.driver.start(rig.clock.now());
  ASSERT_FALSE(first);
  EXPECT_EQ(first.error().code, DriverErrorCode::not_ready);

  rig.clock.advance(core::Duration::microseconds(10));
  const auto early = rig.driver.start(rig.clock.now());
  ASSERT_FALSE(early);
  EXPECT_EQ(early.error().code, DriverErrorCode::not_ready);

  rig.clock.advance(core::Duration::microseconds(100));
  EXPECT_TRUE(rig.driver.start(rig.clock.now()));
  EXPECT_TRUE(rig.chip.is_powered());
}

TYPED_TEST(Lsm6dsoStart, TouchesNoReservedRegister) {
  for (const Mode mode : {Mode::data_ready, Mode::fifo}) {
    Rig<TypeParam> rig{{.mode = mode}};
    ASSERT_TRUE(rig.start());
    EXPECT_EQ(rig.chip.reserved_writes(), 0U);
  }
}

TYPED_TEST(Lsm6dsoStart, BringsAForeignConfigurationToItsOwn) {
  Rig<TypeParam> rig;
  rig.chip.upset(0x16, 0xC0);  // CTRL7_G: low-power mode and high-pass filter
  rig.chip.upset(0x13, 0x42);  // CTRL4_C: sleep, LPF1
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x16), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x13), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x12), 0x44);  // CTRL3_C: BDU, IF_INC
  EXPECT_EQ(rig.chip.read_register(0x11), 0x40);  // CTRL2_G: 104 Hz, 250 deg/s
  EXPECT_EQ(rig.chip.read_register(0x18), 0xE2);  // CTRL9_XL: reset value and I3C_disable
}

TYPED_TEST(Lsm6dsoStart, RefusesAnotherChip) {
  Rig<TypeParam> rig;
  rig.chip.upset(0x0F, 0x6C ^ 0x6B);  // an LSM6DSR
  const auto started = rig.start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error(), (DriverError{DriverErrorCode::wrong_identity, {}, 0x0F}));
}

TYPED_TEST(Lsm6dsoStart, TakesAStuckLineForAMissingChip) {
  for (const auto kind : {Fault::Kind::stuck_high, Fault::Kind::stuck_low}) {
    Rig<TypeParam> rig;
    rig.faults.inject({.kind = kind, .calls = Fault::kForEver});
    const auto started = rig.start();
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, DriverErrorCode::wrong_identity);
  }
}

TYPED_TEST(Lsm6dsoStart, ReportsTheBusErrorOfEveryCallAndThenRecovers) {
  Rig<TypeParam> counter;
  ASSERT_TRUE(counter.start());
  const std::size_t calls = counter.faults.calls();
  ASSERT_GT(calls, 30U);
  for (const auto kind : {Fault::Kind::refused, Fault::Kind::after_effect}) {
    for (std::size_t call = 0; call < calls; ++call) {
      Rig<TypeParam> rig;
      rig.faults.inject({.kind = kind, .first = call, .error = hal::BusError::timeout});
      const auto failed = rig.start();
      ASSERT_FALSE(failed) << "call " << call;
      EXPECT_EQ(failed.error().code, DriverErrorCode::bus_failed);
      EXPECT_EQ(failed.error().bus, hal::BusError::timeout);
      EXPECT_TRUE(rig.start()) << "after a fault in call " << call;
    }
  }
}

TYPED_TEST(Lsm6dsoStart, NeverSucceedsWithAWrongConfigurationWhateverBitFlips) {
  Rig<TypeParam> counter;
  ASSERT_TRUE(counter.start());
  const std::size_t calls = counter.faults.calls();
  for (std::size_t call = 0; call < calls; ++call) {
    for (std::size_t bit = 0; bit < 8; ++bit) {
      Rig<TypeParam> rig;
      rig.faults.inject({.kind = Fault::Kind::flipped_bit, .first = call, .bit = bit});
      if (!rig.start()) continue;
      // It may pass, for instance where the bit is none of ours; then the chip must be right, but
      // for bits of a register that a corrupted read-modify-write set outside our fields.
      for (std::size_t entry = 0; entry < 11; ++entry) EXPECT_TRUE(rig.driver.verify_next());
      EXPECT_EQ(rig.chip.read_register(0x11), 0x40) << "call " << call << " bit " << bit;
    }
  }
}

TYPED_TEST(Lsm6dsoStart, ReportsARegisterThatDoesNotTakeItsValue) {
  // The read-back of the first entry is the sixth call: identity, reset, identity, CTRL3_C, then
  // read, write and read back.
  Rig<TypeParam> rig;
  rig.faults.inject({.kind = Fault::Kind::flipped_bit, .first = 6, .bit = 6});  // BDU
  ASSERT_FALSE(rig.driver.start(rig.clock.now()));
  rig.clock.advance(core::Duration::milliseconds(1));
  const auto started = rig.driver.start(rig.clock.now());
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error(), (DriverError{DriverErrorCode::configuration_lost, {}, 0x12}));
}

TYPED_TEST(Lsm6dsoStart, ReadsTheChipsOwnPeriod) {
  Rig<TypeParam> rig{{}, 20};  // 3 % fast
  EXPECT_NEAR(rig.driver.sample_period().in_seconds(), 64.0F / 6667.0F, 1e-8F);
  ASSERT_TRUE(rig.start());
  EXPECT_NEAR(rig.driver.sample_period().in_seconds(), 64.0F / 6667.0F / 1.03F, 1e-8F);
}

TYPED_TEST(Lsm6dsoStart, ReadingAndVerifyingMustWaitForIt) {
  Rig<TypeParam> rig;
  std::array<GyroSample, 1> out{};
  const auto read = rig.read(out);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, DriverErrorCode::not_ready);
  const auto verified = rig.driver.verify_next();
  ASSERT_FALSE(verified);
  EXPECT_EQ(verified.error().code, DriverErrorCode::not_ready);
  EXPECT_EQ(rig.faults.calls(), 0U);
}

TYPED_TEST(Lsm6dsoRunning, VerifiesEveryEntryInElevenCalls) {
  constexpr std::array<std::uint8_t, 11> kConfigured{0x12, 0x18, 0x13, 0x16, 0x10, 0x0D,
                                                     0x07, 0x08, 0x09, 0x0A, 0x11};
  for (const std::uint8_t address : kConfigured) {
    Rig<TypeParam> rig;
    ASSERT_TRUE(rig.start());
    rig.chip.upset(address, 0x42);  // in every register at least one of these bits is ours
    int refused_calls = 0;
    for (int call = 0; call < 11; ++call) {
      const auto verified = rig.driver.verify_next();
      if (verified) continue;
      ++refused_calls;
      EXPECT_EQ(verified.error(), (DriverError{DriverErrorCode::configuration_lost, {}, address}));
    }
    EXPECT_GE(refused_calls, 1) << int{address};
  }
}

TYPED_TEST(Lsm6dsoRunning, NoticesAnInterruptedSupplyAndStartsAgain) {
  Rig<TypeParam> rig;
  ASSERT_TRUE(rig.start());
  for (int call = 0; call < 22; ++call) ASSERT_TRUE(rig.driver.verify_next());
  rig.chip.cycle_power();
  int calls = 0;
  while (rig.driver.verify_next() && calls < 11) ++calls;
  EXPECT_LT(calls, 11);
  ASSERT_TRUE(rig.start());
  for (int call = 0; call < 11; ++call) EXPECT_TRUE(rig.driver.verify_next());
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

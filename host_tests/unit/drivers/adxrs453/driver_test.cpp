/// @file
/// Particulars of the ADXRS453; the rest is in host_tests/contract.

#include "drivers/adxrs453/driver.hpp"

#include <gtest/gtest.h>

#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using Rig = support::GyroRig<support::OverFrames<support::Adxrs453>>;

support::Rates about_z(float dps) {
  return {core::AngularRate{}, core::AngularRate{}, deg_per_s(dps)};
}

constexpr core::Duration kPeriod = core::Duration::milliseconds(5);

TEST(Adxrs453Sample, IsRefusedWhicheverBitOfAReplyFlips) {
  for (std::size_t call = 1; call <= 2; ++call) {  // the first reply is not looked at
    for (std::size_t bit = 0; bit < 32; ++bit) {
      Rig rig;
      ASSERT_TRUE(rig.start_and_settle());
      rig.sample(about_z(12.0F));
      rig.faults.inject(
          {.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls() + call, .bit = bit});
      std::array<GyroSample, 1> out{};
      const auto read = rig.read(out);
      ASSERT_FALSE(read) << "call " << call << " bit " << bit;
      EXPECT_EQ(read.error().code, DriverErrorCode::corrupt_data);
    }
  }
}

TEST(Adxrs453Sample, IsRefusedForEachFaultThatTheChipTells) {
  for (unsigned bit = 1; bit < 8; ++bit) {
    Rig rig;
    ASSERT_TRUE(rig.start_and_settle());
    rig.chip.upset(0x0B, static_cast<std::uint8_t>(1U << bit));
    rig.sample(about_z(12.0F));
    std::array<GyroSample, 1> out{};
    EXPECT_EQ(rig.read(out).error(), (DriverError{DriverErrorCode::sensor_fault, {}, 0x00})) << bit;
  }
}

TEST(Adxrs453Sample, IsThatOfThisRequestAndNotOfTheOneBefore) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  std::array<GyroSample, 1> out{};
  for (int i = 0; i < 20; ++i) {
    const auto sent = static_cast<float>(i);
    rig.sample(about_z(sent));
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    EXPECT_NEAR(out[0].rate[0].in(deg_per_s), sent, 0.007F);
  }
}

TEST(Adxrs453Sample, IsRefusedIfTheReplyCarriesAnotherSequence) {
  // A frame that got lost on the bus: the chip replies to an older request.
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample({});
  std::array<GyroSample, 1> out{};
  ASSERT_TRUE(rig.read(out));
  rig.sample({});
  SpiFrames frames{rig.bus};
  ASSERT_TRUE(frames.exchange(0x20000000U));
  rig.faults.inject({.kind = Fault::Kind::stuck_low, .first = rig.faults.calls()});
  const auto read = rig.read(out);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, DriverErrorCode::corrupt_data);
}

TEST(Adxrs453Sample, IsTakenOnceAPeriodHoweverOftenItIsAskedFor) {
  Rig rig;
  ASSERT_TRUE(rig.start());
  std::array<GyroSample, 1> out{};
  std::size_t samples = 0;
  const core::Instant begin = rig.clock.now();
  for (int i = 0; i < 1000; ++i) {
    rig.clock.advance(core::Duration::microseconds(700));
    const std::size_t count = rig.read(out).value_or(0);
    EXPECT_TRUE(count == 0 || out[0].time == rig.clock.now());
    samples += count;
  }
  // The first is due at once. Being late by up to 0.7 ms does not add up.
  const std::int64_t periods = (rig.clock.now() - begin) / kPeriod;
  EXPECT_NEAR(static_cast<double>(samples), static_cast<double>(periods + 1), 1.0);
}

TEST(Adxrs453Sample, OfAPeriodThatWasMissedIsNotMadeUpFor) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  std::array<GyroSample, 4> out{};
  EXPECT_EQ(rig.read(out).value_or(0), 1U);
  EXPECT_EQ(rig.read(out).value_or(9), 0U);
}

TEST(Adxrs453Start, RefusesAChipThatCannotShowItsFaults) {
  Rig rig;
  // The check's command does not arrive: its faults never show.
  rig.faults.inject({.kind = Fault::Kind::stuck_low, .first = 0});
  const auto started = rig.start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error(), (DriverError{DriverErrorCode::sensor_fault, {}, 0x00}));
  EXPECT_TRUE(rig.start());
}

TEST(Adxrs453Start, RefusesAChipWithAFaultAndTakesItWhenTheFaultIsGone) {
  Rig rig;
  rig.chip.upset(0x0A, 0x02);  // OV
  const auto started = rig.start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error(), (DriverError{DriverErrorCode::sensor_fault, {}, 0x0A}));
  EXPECT_TRUE(rig.start());
}

TEST(Adxrs453Start, NoticesAnInterruptedSupplyInTheSamplesToo) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.chip.cycle_power();
  rig.clock.advance(kPeriod);
  std::array<GyroSample, 1> out{};
  EXPECT_FALSE(rig.read(out));
  ASSERT_TRUE(rig.start());
  rig.sample({});
  EXPECT_EQ(rig.read(out).value_or(0), 1U);
}

TEST(Adxrs453OnScriptedSpi, SendsTheStartUpSequenceOfTheDatasheet) {
  using hal::testing::exchanges;
  hal::testing::ScriptedSpiDevice spi;
  Adxrs453 driver{SpiFrames{spi}};
  const auto at_ms = [](std::int64_t ms) {
    return core::Instant{} + core::Duration::milliseconds(ms);
  };
  const auto is_not_ready = [&](core::Instant now) {
    return driver.start(now).error().code == DriverErrorCode::not_ready;
  };
  EXPECT_TRUE(is_not_ready(at_ms(0)));
  EXPECT_TRUE(is_not_ready(at_ms(99)));
  spi.expect({exchanges({0x20, 0x00, 0x00, 0x03}, {0x00, 0x00, 0x00, 0x01})});
  EXPECT_TRUE(is_not_ready(at_ms(100)));
  EXPECT_TRUE(is_not_ready(at_ms(149)));
  spi.expect({exchanges({0x20, 0x00, 0x00, 0x00}, {0x04, 0x00, 0x00, 0x00})});
  EXPECT_TRUE(is_not_ready(at_ms(150)));
  EXPECT_TRUE(is_not_ready(at_ms(199)));
  // ST is 10, all faults, 7 of them: P0 stays 0, P1 makes 9 ones.
  spi.expect({exchanges({0x20, 0x00, 0x00, 0x00}, {0x08, 0x00, 0x00, 0xFF})});
  spi.expect({exchanges({0x20, 0x00, 0x00, 0x00}, {0x08, 0x00, 0x00, 0xFF})});
  EXPECT_TRUE(is_not_ready(at_ms(200)));
  EXPECT_TRUE(is_not_ready(at_ms(249)));
}

}  // namespace
}  // namespace zerorate::drivers

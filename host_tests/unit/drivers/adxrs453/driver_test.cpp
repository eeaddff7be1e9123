/// @file
/// Particulars of the ADXRS453 and of its codec; the rest is in host_tests/contract.

#include "drivers/adxrs453/driver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drivers/adxrs453/codec.hpp"
#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::drivers::adxrs453 {
namespace {

TEST(Adxrs453Commands, AreThoseOfTheDatasheet) {
  EXPECT_EQ(encode_sensor_data(0), 0x20000000U);
  EXPECT_EQ(kCheckCommand, 0x20000003U);
  EXPECT_EQ(encode_read(0x00), 0x80000000U);
  EXPECT_EQ(encode_read(0x0C), 0x80180000U);
  EXPECT_EQ(encode_read(0x02), 0x80040001U);
}

TEST(Adxrs453SensorDataCommand, HasTheSequenceInBits31And30And28) {
  EXPECT_EQ(encode_sensor_data(1), 0x60000001U);
  EXPECT_EQ(encode_sensor_data(2), 0xA0000001U);
  EXPECT_EQ(encode_sensor_data(4), 0x30000001U);
  EXPECT_EQ(encode_sensor_data(7), 0xF0000001U);
}

TEST(Adxrs453Commands, HaveAnOddNumberOfOnes) {
  for (unsigned address = 0; address < 0x80; ++address) {
    EXPECT_EQ(std::popcount(encode_read(static_cast<std::uint8_t>(address))) % 2, 1);
  }
  for (std::uint8_t sequence = 0; sequence < 8; ++sequence) {
    EXPECT_EQ(std::popcount(encode_sensor_data(sequence)) % 2, 1);
  }
}

/// Sequence 5, P0, valid, rate 1234h, no faults: 101 0 01 and the data; 11 ones, P1 is 0 after P0.
constexpr std::uint32_t kReply = 0xA4000000U | (0x1234U << 10U);

TEST(Adxrs453Parity, IsOddOverTheUpperHalfAndOverAll) {
  // Upper half A448h: 5 ones, so P0 is 0. Lower half D000h: 3 ones; 8 in all, so P1 is 1.
  EXPECT_EQ(kReply >> 16U, 0xA448U);
  EXPECT_EQ(kReply & 0xFFFFU, 0xD000U);
  EXPECT_TRUE(has_good_parity(kReply | 1U));
  EXPECT_FALSE(has_good_parity(kReply));
  for (unsigned bit = 0; bit < 32; ++bit) {
    EXPECT_FALSE(has_good_parity((kReply | 1U) ^ (1U << bit))) << bit;
  }
  EXPECT_FALSE(has_good_parity(0U));
  EXPECT_FALSE(has_good_parity(0xFFFFFFFFU));
}

TEST(Adxrs453SensorReply, HoldsSequenceStatusRateAndFaults) {
  const SensorReply reply = decode_sensor_reply(kReply | 0x80U | 1U);
  EXPECT_EQ(reply.sequence, 5);
  EXPECT_EQ(reply.status, Status::valid);
  EXPECT_EQ(reply.rate_raw, 0x1234);
  EXPECT_EQ(reply.faults, 0x80) << "the parity bit is not a fault";
  EXPECT_EQ(decode_sensor_reply(0x02000000U).rate_raw, std::numeric_limits<std::int16_t>::min());
  EXPECT_EQ(decode_sensor_reply(0x03FFFC00U).rate_raw, -1);
}

TEST(Adxrs453ReadReply, IsToldFromSensorDataWritesAndErrors) {
  EXPECT_TRUE(is_read_reply(0x4E000000U));
  EXPECT_TRUE(is_read_reply(0x5E0A4041U)) << "P0 is not looked at";
  EXPECT_FALSE(is_read_reply(0x2E000000U)) << "write";
  EXPECT_FALSE(is_read_reply(0x0E000000U)) << "error";
  EXPECT_FALSE(is_read_reply(kReply));
  EXPECT_EQ(decode_read_data(0x4E0A4040U), 0x5202);
}

TEST(Adxrs453Temperature, IsTenBitsAbout45Degrees) {
  EXPECT_EQ(decode_temperature(0x0000).degc(), 45.0F);
  EXPECT_NEAR(decode_temperature(0x0140).degc(), 46.0F, 1e-5F);
  EXPECT_NEAR(decode_temperature(static_cast<std::uint16_t>(-425 * 64)).degc(), -40.0F, 1e-5F);
  EXPECT_NEAR(decode_temperature(200 * 64).degc(), 85.0F, 1e-5F);
}

TEST(Adxrs453Lsb, IsOneEightiethOfADegreeASecond) {
  EXPECT_NEAR(kLsb.in(core::deg_per_s), 0.0125, 0.0125 * 4.0 * std::exp2(-24));
  EXPECT_EQ(kFullScaleRaw, 24000);
}

}  // namespace
}  // namespace zerorate::drivers::adxrs453

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using Rig = support::GyroRig<support::OverSpi<support::Adxrs453>>;

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

TEST(Adxrs453Start, RefusesAChipUntilItsFaultIsGone) {
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

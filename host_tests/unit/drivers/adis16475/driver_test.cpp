/// @file
/// Particulars of the ADIS16475, of its relatives and of their codec; the rest is in
/// host_tests/contract.

#include "drivers/adis16475/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "drivers/adis16475/chip.hpp"
#include "drivers/adis16475/codec.hpp"
#include "hal/testing/fault_injector.hpp"
#include "host_tests/support/simulated_accelerometers.hpp"

namespace zerorate::drivers::adis16475 {
namespace {

TEST(Adis16475Words, AreThoseOfTheDatasheet) {
  EXPECT_EQ(encode_read(kProdId), 0x7200);
  EXPECT_EQ(encode_write(kGlobCmd, bits::kGlobCmdReset), 0xE880);
  EXPECT_EQ(encode_write(0x65, 0x07), 0xE507);
  EXPECT_EQ(encode_read(kGlobCmd), kBurstCommand) << "a burst is a read of GLOB_CMD";
}

/// The bytes of the words, and their checksum.
std::array<std::uint8_t, kBurstBytes> burst_of(const std::array<std::uint16_t, 9>& words) {
  std::array<std::uint8_t, kBurstBytes> bytes{};
  unsigned sum = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    bytes.at(2 * i) = static_cast<std::uint8_t>(words.at(i) >> 8U);
    bytes.at(2 * i + 1) = static_cast<std::uint8_t>(words.at(i) & 0xFFU);
    sum += (words.at(i) >> 8U) + (words.at(i) & 0xFFU);
  }
  bytes[18] = static_cast<std::uint8_t>(sum >> 8U);
  bytes[19] = static_cast<std::uint8_t>(sum & 0xFFU);
  return bytes;
}

TEST(Adis16475Burst, HoldsStatusRatesForcesTemperatureAndCounter) {
  const Burst burst = decode_burst(
      burst_of({0x0008, 0x7FFF, 0x8000, 0xFFFF, 0x0001, 0x1234, 0xFEDC, 0xFF83, 0xABCD}));
  EXPECT_TRUE(burst.is_intact);
  EXPECT_EQ(burst.status, 0x0008);
  EXPECT_EQ(burst.rate, (std::array<std::int16_t, 3>{32767, -32768, -1}));
  EXPECT_EQ(burst.force, (std::array<std::int16_t, 3>{1, 0x1234, -292}));
  EXPECT_EQ(burst.temperature, -125);
  EXPECT_EQ(burst.counter, 0xABCD);
}

TEST(Adis16475Burst, OfZerosIsThatOfADeadLine) {
  EXPECT_FALSE(decode_burst(burst_of({})).is_intact);
  const Burst burst = decode_burst(burst_of({0, 0, 0, 0, 0, 0, 0, 0, 1}));
  EXPECT_TRUE(burst.is_intact);
  EXPECT_EQ(burst.rate, (std::array<std::int16_t, 3>{}));
}

TEST(Adis16475Burst, IsNotIntactWhicheverBitFlips) {
  const auto bytes = burst_of({0, 1, 2, 3, 4, 5, 6, 7, 8});
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    auto flipped = bytes;
    flipped.at(bit / 8) ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_FALSE(decode_burst(flipped).is_intact) << bit;
  }
}

TEST(Adis16475Burst, WithTheLargestSumIsIntact) {
  constexpr std::uint16_t kAll = 0xFFFF;
  EXPECT_TRUE(
      decode_burst(burst_of({kAll, kAll, kAll, kAll, kAll, kAll, kAll, kAll, kAll})).is_intact);
}

TEST(Adis16475Temperature, IsATenthOfADegreeACount) {
  EXPECT_EQ(decode_temperature(0).degc(), 0.0F);
  EXPECT_NEAR(decode_temperature(250).degc(), 25.0F, 1e-5F);
  EXPECT_NEAR(decode_temperature(-400).degc(), -40.0F, 1e-5F);
  EXPECT_NEAR(decode_temperature(32767).degc(), 3276.7F, 1e-3F);
  EXPECT_NEAR(decode_temperature(-32768).degc(), -3276.8F, 1e-3F);
}

TEST(Adis16475Lsb, IsThatOfThePart) {
  const auto expect = [](Part part, double dps, double mg) {
    const double rounding = 4.0 * std::exp2(-24);
    EXPECT_NEAR(lsb(variant(part)).in(core::deg_per_s), dps, dps * rounding);
    EXPECT_NEAR(acceleration_lsb(variant(part)).in(core::standard_gravity), 1e-3 * mg,
                1e-3 * mg * rounding);
  };
  expect(Part::adis16470, 1.0 / 10.0, 1.25);
  expect(Part::adis16475_1, 1.0 / 160.0, 0.25);
  expect(Part::adis16475_2, 1.0 / 40.0, 0.25);
  expect(Part::adis16475_3, 1.0 / 10.0, 0.25);
}

TEST(Adis16475Rates, AreMeansOfSamplesAt2000Hz) {
  for (const auto& rate : Chip::kRates) {
    EXPECT_EQ(static_cast<double>(sample_period(rate.code).ns()), 1e9 / rate.value);
    EXPECT_EQ(2000.0 / (encode_dec_rate(rate.code) + 1), rate.value);
  }
}

TEST(Adis16475Counter, ShowsAResetThatTheTimeDoesNotAllow) {
  constexpr core::Duration kPeriod = core::Duration::milliseconds(10);
  EXPECT_FALSE(was_reset(1, {}, kPeriod));
  EXPECT_FALSE(was_reset(208, core::Duration::seconds(1), kPeriod));
  EXPECT_TRUE(was_reset(209, core::Duration::seconds(1), kPeriod));
  EXPECT_TRUE(was_reset(0xFFFF, core::Duration::seconds(300), kPeriod));
  EXPECT_FALSE(was_reset(0xFFFF, core::Duration::seconds(400), kPeriod)) << "it may have wrapped";
}

}  // namespace
}  // namespace zerorate::drivers::adis16475

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using Rig = support::GyroRig<support::OverSpi<support::Adis16470>>;

constexpr support::Rates kBend{deg_per_s(12.0F), deg_per_s(-3.0F), deg_per_s(40.0F)};

std::size_t read_one(Rig& rig) {
  std::array<GyroSample, 4> out{};
  return rig.read(out).value_or(9);
}

TEST(Adis16475Sample, IsRefusedForEachFaultThatTheChipTells) {
  for (const unsigned bit : {1U, 2U, 4U, 5U, 6U, 7U, 8U, 9U, 10U}) {
    Rig rig;
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample(kBend);
    rig.chip.fail(static_cast<std::uint16_t>(1U << bit));
    std::array<GyroSample, 1> out{};
    EXPECT_EQ(rig.read(out).error(), (DriverError{DriverErrorCode::sensor_fault, {}, 0x02})) << bit;
  }
}

TEST(Adis16475Sample, AfterBrokenClocksIsCorruptOnce) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample(kBend);
  rig.chip.refuse_clocks();
  std::array<GyroSample, 1> out{};
  EXPECT_EQ(rig.read(out).error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x02}));
  EXPECT_EQ(read_one(rig), 1U) << "the fault is over, and the sample is still there";
}

TEST(Adis16475Start, IsRefusedWhileTheChipReportsAFault) {
  Rig rig;
  auto result = rig.driver.start(rig.clock.now());
  while (support::is_waiting(result)) {
    rig.clock.advance(core::Duration::milliseconds(1));
    rig.chip.fail(0x0040);  // the flash test fails
    result = rig.driver.start(rig.clock.now());
  }
  EXPECT_EQ(result.error(), (DriverError{DriverErrorCode::sensor_fault, {}, 0x02}));
}

TEST(Adis16475Count, TellsRepeatedReadsFromLostSamples) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample(kBend);
  EXPECT_EQ(read_one(rig), 1U);
  EXPECT_EQ(read_one(rig), 0U);
  EXPECT_EQ(rig.driver.lost_samples(), 0U);
  for (int i = 0; i < 4; ++i) rig.sample(kBend);
  EXPECT_EQ(read_one(rig), 1U);
  EXPECT_EQ(rig.driver.lost_samples(), 3U);
}

TEST(Adis16475Count, GoesOnPastItsEnd) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 0x10000; ++i) {
    rig.sample(kBend);
    ASSERT_EQ(read_one(rig), 1U) << i;
  }
  EXPECT_EQ(rig.driver.lost_samples(), 0U);
}

TEST(Adis16475Reset, ShowsInTheCountWhereNoRegisterShowsIt) {
  Rig rig{{.rate = adis16475::OutputDataRate::hz_2000}};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 100; ++i) {
    rig.sample(kBend);
    ASSERT_EQ(read_one(rig), 1U);
  }
  rig.chip.cycle_power();
  rig.clock.advance(core::Duration::seconds(1));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(rig.driver.verify_next());
  rig.sample(kBend);
  const DriverError lost{DriverErrorCode::configuration_lost, {}, 0x22};
  std::array<GyroSample, 1> out{};
  EXPECT_EQ(rig.read(out).error(), lost);
  EXPECT_EQ(rig.driver.verify_next().error(), lost) << "the loop asks so for lost power";
  ASSERT_TRUE(rig.start_and_settle());
  EXPECT_TRUE(rig.driver.verify_next());
  rig.sample(kBend);
  EXPECT_EQ(read_one(rig), 1U);
}

TEST(Adis16475Start, RefusesAModelWithAnotherFullScale) {
  hal::sim::SimulatedClock clock;
  hal::sim::SimulatedAdis16475Part3 chip{clock};
  hal::sim::SimulatedWordSpi device{chip};
  Adis16475 driver{SpiWords{device}, adis16475::SettingsOf<adis16475::Part::adis16475_2>{}};
  auto result = driver.start(clock.now());
  while (!result && result.error().code == DriverErrorCode::not_ready) {
    clock.advance(core::Duration::milliseconds(1));
    result = driver.start(clock.now());
  }
  EXPECT_EQ(result.error(), (DriverError{DriverErrorCode::wrong_identity, {}, 0x5E}));
}

TEST(Adis16475Acceleration, IsThatOfTheBurstOfTheRate) {
  support::GyroRig<support::OverSpi<support::Adis16475Part2WithAcceleration>> rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.chip.set_specific_force({core::standard_gravity(0.5F), core::standard_gravity(-0.25F), {}});
  rig.sample(kBend);
  std::array<GyroSample, 1> out{};
  const std::size_t before = rig.faults.calls();
  ASSERT_EQ(rig.read(out).value_or(0), 1U);
  EXPECT_EQ(rig.faults.calls(), before + 1);
  ASSERT_TRUE(out[0].has_acceleration);
  EXPECT_NEAR(out[0].acceleration[1].in(core::standard_gravity), -0.25F, 1e-6F);
}

}  // namespace
}  // namespace zerorate::drivers

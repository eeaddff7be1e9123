/// @file
/// Particulars of the ICM-45686 and of its codec; the rest is in host_tests/contract.

#include "drivers/icm45686/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "drivers/icm45686/codec.hpp"
#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::drivers::icm45686 {
namespace {

TEST(Icm45686Lsb, IsTheFullScaleByTwoToThe15) {
  double full_scale_dps = 4000.0;
  for (int code = 0; code < 9; ++code, full_scale_dps /= 2.0) {
    const double expected = full_scale_dps / 32768.0 * std::numbers::pi / 180.0;
    const double got = lsb(static_cast<FullScale>(code)).in(core::rad_per_s);
    // Roundings of pi / 180 and of the product, each at most 2^-24 of the value.
    EXPECT_NEAR(got, expected, expected * 2.0 * std::exp2(-24)) << code;
  }
}

TEST(Icm45686Lsb, AgreesWithLinux) {
  // rad/s a count, as inv_icm45600 gives them, rounded to 1e-9.
  constexpr std::array kScales{2130529e-9, 1065264e-9, 532632e-9, 266316e-9, 133158e-9,
                               66579e-9,   33290e-9,   16645e-9,  8322e-9};
  for (std::size_t code = 0; code < kScales.size(); ++code) {
    EXPECT_NEAR(lsb(static_cast<FullScale>(code)).in(core::rad_per_s), kScales.at(code), 0.51e-9);
  }
}

TEST(Icm45686Temperature, Is25DegreesAtZero) {
  EXPECT_EQ(decode_temperature(0).degc(), 25.0F);
  EXPECT_EQ(decode_temperature(12800).degc(), 125.0F);
  EXPECT_EQ(decode_temperature(-8320).degc(), -40.0F);
}

TEST(Icm45686FifoCount, CountsPacketsLowByteFirst) {
  EXPECT_EQ(decode_fifo_count(0x02, 0x00, 8).packets, 2);
  EXPECT_EQ(decode_fifo_count(0x02, 0x01, 8).packets, 258);
}

TEST(Icm45686FifoCount, KnowsFullAndImpossible) {
  EXPECT_FALSE(decode_fifo_count(0xFF, 0x00, 8).is_full);
  EXPECT_TRUE(decode_fifo_count(0x00, 0x01, 8).is_full);
  EXPECT_TRUE(decode_fifo_count(0x80, 0x00, 16).is_full);
  EXPECT_TRUE(decode_fifo_count(0x00, 0x04, 8).is_plausible);
  EXPECT_FALSE(decode_fifo_count(0x01, 0x04, 8).is_plausible);
  EXPECT_FALSE(decode_fifo_count(0xFF, 0xFF, 8).is_plausible);
}

TEST(Icm45686GyroConfig0, HoldsRangeAboveRate) {
  EXPECT_EQ(encode_gyro_config0(OutputDataRate::hz_100, FullScale::dps_250), 0x49);
  EXPECT_EQ(encode_gyro_config0(OutputDataRate::hz_1600, FullScale::dps_4000), 0x05);
  EXPECT_EQ(encode_gyro_config0(OutputDataRate::hz_12_5, FullScale::dps_15_625), 0x8C);
}

TEST(Icm45686SamplePeriod, IsThatOfTheNamedRate) {
  EXPECT_EQ(sample_period(OutputDataRate::hz_12_5), core::Duration::milliseconds(80));
  EXPECT_EQ(sample_period(OutputDataRate::hz_25), core::Duration::milliseconds(40));
  EXPECT_EQ(sample_period(OutputDataRate::hz_50), core::Duration::milliseconds(20));
  EXPECT_EQ(sample_period(OutputDataRate::hz_100), core::Duration::milliseconds(10));
  EXPECT_EQ(sample_period(OutputDataRate::hz_200), core::Duration::milliseconds(5));
  EXPECT_EQ(sample_period(OutputDataRate::hz_400), core::Duration::microseconds(2500));
  EXPECT_EQ(sample_period(OutputDataRate::hz_800), core::Duration::microseconds(1250));
  EXPECT_EQ(sample_period(OutputDataRate::hz_1600), core::Duration::microseconds(625));
}

}  // namespace
}  // namespace zerorate::drivers::icm45686

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using icm45686::Mode;
using icm45686::Settings;
using Rig = support::GyroRig<support::OverSpi<support::Icm45686>>;

/// A register behind the window of a chip that is on SPI.
template <class Rig>
std::uint8_t behind_window(Rig& rig, std::uint8_t address) {
  SpiRegisters spi{rig.bus};
  icm45686::IndirectRegisters<decltype(spi)> registers{spi};
  std::array<std::uint8_t, 1> value{};
  EXPECT_TRUE(registers.read(address, value));
  return value[0];
}

TEST(Icm45686, ConfiguresTheRegistersThatTheMakerNames) {
  Rig rig{{.mode = Mode::fifo, .fifo_watermark = 40}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x10), 0x0C);  // PWR_MGMT0: gyro in low-noise mode
  EXPECT_EQ(rig.chip.read_register(0x16), 0x03);  // INT1_CONFIG0: watermark, full
  EXPECT_EQ(rig.chip.read_register(0x18), 0x01);  // INT1_CONFIG2: push-pull, pulsed, active high
  EXPECT_EQ(rig.chip.read_register(0x1C), 0x49);  // GYRO_CONFIG0: 250 deg/s, 100 Hz
  EXPECT_EQ(rig.chip.read_register(0x1D), 0x87);  // FIFO_CONFIG0: stop on full, 2 kbyte
  EXPECT_EQ(rig.chip.read_register(0x1E), 0x28);  // FIFO_CONFIG1: 40 packets
  EXPECT_EQ(rig.chip.read_register(0x1F), 0x00);
  EXPECT_EQ(rig.chip.read_register(0x20), 0x28);  // FIFO_CONFIG2: from the watermark on
  EXPECT_EQ(rig.chip.read_register(0x21), 0x05);  // FIFO_CONFIG3: open, gyro
  EXPECT_EQ(rig.chip.read_register(0x22), 0x00);  // FIFO_CONFIG4: no time, no compression
  EXPECT_EQ(behind_window(rig, 0x81), 0x81);      // the filter, a quarter of the rate
  EXPECT_EQ(behind_window(rig, 0x80), 0x00);      // SREG_CTRL: low byte first
}

TEST(Icm45686, ARegisterThatIsNeverDoneIsATimeout) {
  hal::testing::ScriptedSpiDevice spi;
  using hal::testing::reads;
  using hal::testing::writes;
  for (int question = 0; question < 16; ++question) {
    spi.expect({writes({0xFF}), reads({0x00})});
  }
  SpiRegisters bus{spi};
  icm45686::IndirectRegisters<decltype(bus)> registers{bus};
  const auto written = registers.write(0x81, 0x01);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error(), hal::BusError::timeout);
}

TEST(Icm45686, WritesAddressAndValueInOneTransaction) {
  hal::testing::ScriptedSpiDevice spi;
  using hal::testing::reads;
  using hal::testing::writes;
  spi.expect({writes({0xFF}), reads({0x01})});
  spi.expect({writes({0x7C, 0xA4, 0xAC, 0x81})});
  SpiRegisters bus{spi};
  icm45686::IndirectRegisters<decltype(bus)> registers{bus};
  EXPECT_TRUE(registers.write(0x81, 0x81));
}

TEST(Icm45686, SetsTheFilterAgainAfterAnUpset) {
  Rig rig;
  ASSERT_TRUE(rig.start());
  rig.chip.upset(0x81, 0x05);
  int lost = 0;
  for (int call = 0; call < 20; ++call) lost += rig.driver.verify_next() ? 0 : 1;
  EXPECT_GT(lost, 0);
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(behind_window(rig, 0x81), 0x81);
}

TEST(Icm45686Fifo, AFlippedHeaderIsCorruptDataAndEmptiesIt) {
  for (std::size_t bit = 4; bit < 8; ++bit) {
    Rig rig{{.mode = Mode::fifo}};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({});
    rig.faults.inject(
        {.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls() + 3, .bit = bit});
    std::array<GyroSample, 4> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << bit;
    EXPECT_EQ(read.error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x14}));
    EXPECT_EQ(rig.read(out).value_or(9), 0U);
    rig.sample({deg_per_s(5.0F), {}, {}});
    ASSERT_EQ(rig.read(out).value_or(9), 1U);
    EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 5.0F, 0.005F);
  }
}

TEST(Icm45686Fifo, ABurstThatBrokeOffDoesNotShiftWhatFollows) {
  Rig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  std::array<GyroSample, 4> out{};
  for (int i = 0; i < 3; ++i) rig.sample({deg_per_s(1.0F), {}, {}});
  rig.faults.inject({.kind = Fault::Kind::after_effect,
                     .first = rig.faults.calls() + 3,
                     .error = hal::BusError::timeout});
  ASSERT_FALSE(rig.read(out));
  std::array<std::uint8_t, 5> part{};  // and more of it than was asked for
  SpiRegisters registers{rig.bus};
  ASSERT_TRUE(registers.read(0x14, part));
  (void)rig.read(out);
  for (int i = 0; i < 3; ++i) {
    rig.sample({deg_per_s(5.0F), {}, {}});
    ASSERT_EQ(rig.read(out).value_or(9), 1U);
    EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 5.0F, 0.005F);
  }
}

TEST(Icm45686Fifo, IsEmptiedWhenItsEmptyingFailedBefore) {
  Rig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 300; ++i) rig.sample({deg_per_s(1.0F), {}, {}});
  rig.faults.inject({.kind = Fault::Kind::refused,
                     .first = rig.faults.calls() + 3,
                     .error = hal::BusError::timeout});
  std::array<GyroSample, 4> out{};
  EXPECT_EQ(rig.read(out).error().code, DriverErrorCode::bus_failed);
  EXPECT_EQ(rig.read(out).value_or(9), 0U);
  rig.sample({deg_per_s(5.0F), {}, {}});
  ASSERT_EQ(rig.read(out).value_or(9), 1U);
  EXPECT_EQ(out[0].time, rig.clock.now());
  EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 5.0F, 0.005F);
}

TEST(Icm45686DataReady, ASampleThatTheChipCallsInvalidIsNone) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample({});
  rig.chip.upset(0x09, 0x80);  // the high byte of y: 0000h becomes 8000h
  std::array<GyroSample, 1> out{};
  EXPECT_EQ(rig.read(out).value_or(9), 0U);
  rig.sample({});
  EXPECT_EQ(rig.read(out).value_or(9), 1U);
}

/// A bus so slow that a conversion falls into every reading.
TEST(Icm45686DataReady, ComesAlsoWhereEveryReadingMeetsAConversion) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample({deg_per_s(1.0F), {}, {}});
  const std::size_t first = rig.faults.calls();
  for (std::size_t reading = 0; reading < 3; ++reading) {
    rig.faults.before(first + 2 + 2 * reading, [&] { rig.sample({deg_per_s(2.0F), {}, {}}); });
  }
  std::array<GyroSample, 1> out{};
  EXPECT_EQ(rig.read(out).value_or(9), 1U);
}

TEST(Icm45686OnScriptedSpi, AsksForTheIdentityAndResetsTheChip) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedSpiDevice spi;
  spi.expect({writes({0xF2}), reads({0xE9})});
  spi.expect({writes({0x7F, 0x02})});
  Icm45686 driver{SpiRegisters{spi}};
  EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::not_ready);
}

}  // namespace
}  // namespace zerorate::drivers

/// @file
/// Particulars of the ICM-42688-P and of its codec; the rest is in host_tests/contract.

#include "drivers/icm42688/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "drivers/icm42688/codec.hpp"
#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::drivers::icm42688 {
namespace {

TEST(Icm42688Lsb, IsTheFullScaleByTwoToThe15) {
  double full_scale_dps = 2000.0;
  for (int code = 0; code < 8; ++code, full_scale_dps /= 2.0) {
    const double expected = full_scale_dps / 32768.0 * std::numbers::pi / 180.0;
    const double got = lsb(static_cast<FullScale>(code)).in(core::rad_per_s);
    // Roundings of pi / 180 and of the product, each at most 2^-24 of the value.
    EXPECT_NEAR(got, expected, expected * 2.0 * std::exp2(-24)) << code;
  }
}

TEST(Icm42688Lsb, AgreesWithTheThreeDigitsOfTheDatasheet) {
  constexpr std::array kLsbPerDps{16.4, 32.8, 65.5, 131.0, 262.0, 524.3, 1048.6, 2097.2};
  for (std::size_t code = 0; code < kLsbPerDps.size(); ++code) {
    const double dps = lsb(static_cast<FullScale>(code)).in(core::deg_per_s);
    EXPECT_NEAR(1.0 / dps, kLsbPerDps[code], 1e-3 * kLsbPerDps[code]);
  }
}

TEST(Icm42688Temperature, Is25DegreesAtZero) {
  EXPECT_EQ(decode_temperature(0).degc(), 25.0F);
  EXPECT_NEAR(decode_temperature(13248).degc(), 125.0F, 1e-4F);
  EXPECT_NEAR(decode_temperature(-6624).degc(), -25.0F, 1e-4F);
}

TEST(Icm42688FifoStatus, CountsCompletePackets) {
  EXPECT_EQ(decode_fifo_status(0x00, 0x00, 0x00).packets, 0);
  EXPECT_EQ(decode_fifo_status(0x00, 0x00, 0x07).packets, 0);
  EXPECT_EQ(decode_fifo_status(0x00, 0x00, 0x10).packets, 2);
  EXPECT_EQ(decode_fifo_status(0x00, 0x08, 0x00).packets, 256);
}

TEST(Icm42688FifoStatus, KnowsFullAndImpossible) {
  EXPECT_FALSE(decode_fifo_status(0x0C, 0x00, 0x08).is_full);
  EXPECT_TRUE(decode_fifo_status(0x02, 0x08, 0x00).is_full);
  EXPECT_TRUE(decode_fifo_status(0x7F, 0x08, 0x00).is_plausible);
  EXPECT_FALSE(decode_fifo_status(0x80, 0x00, 0x08).is_plausible);
  EXPECT_FALSE(decode_fifo_status(0x00, 0x08, 0x01).is_plausible);
  EXPECT_FALSE(decode_fifo_status(0xFF, 0xFF, 0xFF).is_plausible);
}

TEST(Icm42688FifoHeader, IsThatOfGyroAlone) {
  EXPECT_TRUE(is_gyro_header(0x20));
  EXPECT_TRUE(is_gyro_header(0x29)) << "time stamp, first after a change of rate";
  EXPECT_FALSE(is_gyro_header(0x80)) << "empty";
  EXPECT_FALSE(is_gyro_header(0x60)) << "with accelerometer";
  EXPECT_FALSE(is_gyro_header(0x40)) << "accelerometer alone";
  EXPECT_FALSE(is_gyro_header(0x30)) << "20 bits";
}

TEST(Icm42688GyroConfig0, HoldsRangeAboveRate) {
  EXPECT_EQ(encode_gyro_config0(OutputDataRate::hz_100, FullScale::dps_250), 0x68);
  EXPECT_EQ(encode_gyro_config0(OutputDataRate::hz_1000, FullScale::dps_2000), 0x06);
  EXPECT_EQ(encode_gyro_config0(OutputDataRate::hz_500, FullScale::dps_15_625), 0xEF);
}

TEST(Icm42688SamplePeriod, IsThatOfTheNamedRate) {
  EXPECT_EQ(sample_period(OutputDataRate::hz_12_5), core::Duration::milliseconds(80));
  EXPECT_EQ(sample_period(OutputDataRate::hz_25), core::Duration::milliseconds(40));
  EXPECT_EQ(sample_period(OutputDataRate::hz_50), core::Duration::milliseconds(20));
  EXPECT_EQ(sample_period(OutputDataRate::hz_100), core::Duration::milliseconds(10));
  EXPECT_EQ(sample_period(OutputDataRate::hz_200), core::Duration::milliseconds(5));
  EXPECT_EQ(sample_period(OutputDataRate::hz_500), core::Duration::milliseconds(2));
  EXPECT_EQ(sample_period(OutputDataRate::hz_1000), core::Duration::milliseconds(1));
  EXPECT_EQ(sample_period(OutputDataRate::hz_2000), core::Duration::microseconds(500));
}

}  // namespace
}  // namespace zerorate::drivers::icm42688

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using icm42688::Mode;
using icm42688::Settings;
using Rig = support::GyroRig<support::OverSpi<support::Icm42688>>;

TEST(Icm42688, ConfiguresTheRegistersThatTheDatasheetNames) {
  Rig rig{{.mode = Mode::fifo, .fifo_watermark = 40}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x14), 0x03);  // INT_CONFIG: pulsed, push-pull, active high
  EXPECT_EQ(rig.chip.read_register(0x16), 0x40);  // FIFO_CONFIG: stream
  EXPECT_EQ(rig.chip.read_register(0x4C), 0x30);  // INTF_CONFIG0: bytes, big-endian
  EXPECT_EQ(rig.chip.read_register(0x4E), 0x0C);  // PWR_MGMT0: gyro in low-noise mode
  EXPECT_EQ(rig.chip.read_register(0x4F), 0x68);  // GYRO_CONFIG0: 250 deg/s, 100 Hz
  EXPECT_EQ(rig.chip.read_register(0x52), 0x10);  // GYRO_ACCEL_CONFIG0: half the rate
  EXPECT_EQ(rig.chip.read_register(0x5F), 0x26);  // FIFO_CONFIG1: gyro, temperature
  EXPECT_EQ(rig.chip.read_register(0x60), 0x40);  // FIFO_CONFIG2 and 3: 320 bytes
  EXPECT_EQ(rig.chip.read_register(0x61), 0x01);
  EXPECT_EQ(rig.chip.read_register(0x64), 0x00);  // INT_CONFIG1: INT_ASYNC_RESET cleared
  EXPECT_EQ(rig.chip.read_register(0x65), 0x04);  // INT_SOURCE0: FIFO threshold
}

TEST(Icm42688, IsBroughtBackFromAnotherRegisterBank) {
  for (std::uint8_t bank = 1; bank <= 4; ++bank) {
    Rig rig;
    rig.chip.write_register(0x76, bank);
    EXPECT_TRUE(rig.start());
  }
}

TEST(Icm42688Relatives, AreNotTakenForEachOther) {
  using Links = support::OverSpi<support::Icm42605>;
  for (const auto identity : std::to_array<std::uint8_t>({0x42, 0x47, 0x6F})) {
    hal::sim::SimulatedClock clock{};
    hal::sim::SimulatedIcm42688 chip{clock, identity};
    hal::sim::SimulatedSpiDevice<hal::sim::SimulatedIcm42688> bus{chip};
    const auto started_as = [&](const auto& settings) {
      Icm42688 driver{SpiRegisters{bus}, settings};
      return driver.start(clock.now()).error().code == DriverErrorCode::not_ready;
    };
    EXPECT_EQ(started_as(Links::Gyro::Settings{}), identity == 0x42);
    EXPECT_EQ(started_as(icm42688::Settings{}), identity == 0x47);
    EXPECT_EQ(started_as(icm42688::Iim42652::Settings{}), identity == 0x6F);
  }
}

TEST(Icm42688Fifo, KeepsASampleThatWasReadInPart) {
  Rig rig{{.mode = Mode::fifo}};
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample({deg_per_s(5.0F), {}, {}});
  std::array<std::uint8_t, 5> part{};
  SpiRegisters registers{rig.bus};
  ASSERT_TRUE(registers.read(0x30, part));  // a burst that broke off
  std::array<GyroSample, 4> out{};
  ASSERT_EQ(rig.read(out).value_or(0), 1U);
  EXPECT_NEAR(out[0].rate[0].in(deg_per_s), 5.0F, 0.005F);
}

TEST(Icm42688Fifo, AFlippedHeaderIsCorruptData) {
  for (std::size_t bit = 4; bit < 8; ++bit) {
    Rig rig{{.mode = Mode::fifo}};
    ASSERT_TRUE(rig.start_and_settle());
    rig.sample({});
    rig.faults.inject(
        {.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls() + 2, .bit = bit});
    std::array<GyroSample, 4> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << bit;
    EXPECT_EQ(read.error(), (DriverError{DriverErrorCode::corrupt_data, {}, 0x30}));
  }
}

TEST(Icm42688DataReady, ASampleThatTheChipCallsInvalidIsNone) {
  Rig rig;
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample({});
  rig.chip.upset(0x27, 0x80);  // GYRO_DATA_Y1: 0000h becomes 8000h
  std::array<GyroSample, 1> out{};
  EXPECT_EQ(rig.read(out).value_or(9), 0U);
  rig.sample({});
  EXPECT_EQ(rig.read(out).value_or(9), 1U);
}

TEST(Icm42688OnScriptedSpi, AsksForIdentityAndBankAndResetsTheChip) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedSpiDevice spi;
  spi.expect({writes({0xF5}), reads({0x47, 0x00})});
  spi.expect({writes({0x11, 0x01})});
  Icm42688 driver{SpiRegisters{spi}};
  EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::not_ready);
}

}  // namespace
}  // namespace zerorate::drivers

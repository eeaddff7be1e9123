/// @file
/// Particulars of the MPU-6500, of its relatives and of their codec; the rest is in
/// host_tests/contract.

#include "drivers/mpu6500/driver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "drivers/mpu6500/codec.hpp"
#include "hal/testing/scripted_bus.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::drivers::mpu6500 {
namespace {

constexpr const Variant& kMpu6050 = kVariants[0];
constexpr const Variant& kMpu6500 = kVariants[1];

TEST(Mpu6500Lsb, IsTheFullScaleByTwoToThe15) {
  double full_scale_dps = 250.0;
  for (unsigned code = 0; code < 4; ++code, full_scale_dps *= 2.0) {
    const double expected = full_scale_dps / 32768.0 * std::numbers::pi / 180.0;
    const double got = lsb(static_cast<FullScale>(code << 3U)).in(core::rad_per_s);
    // Roundings of pi / 180 and of the product, each at most 2^-24 of the value.
    EXPECT_NEAR(got, expected, expected * 2.0 * std::exp2(-24)) << code;
  }
}

TEST(Mpu6500Lsb, AgreesWithTheThreeDigitsOfTheDatasheet) {
  constexpr std::array kLsbPerDps{131.0, 65.5, 32.8, 16.4};
  for (std::size_t code = 0; code < kLsbPerDps.size(); ++code) {
    const double dps = lsb(static_cast<FullScale>(code << 3U)).in(core::deg_per_s);
    EXPECT_NEAR(1.0 / dps, kLsbPerDps[code], 1e-3 * kLsbPerDps[code]);
  }
}

TEST(Mpu6500Variant, IsToldByTheIdentity) {
  EXPECT_EQ(find_variant(0x70), &kMpu6500);
  EXPECT_EQ(find_variant(0x68), &kMpu6050);
  EXPECT_EQ(find_variant(0x00), nullptr);
  EXPECT_EQ(find_variant(0xFF), nullptr);
  EXPECT_EQ(find_variant(0x47), nullptr) << "ICM-42688-P, at the same address";
  EXPECT_EQ(find_variant(0x0F), nullptr) << "BMI088, at the same address";
}

TEST(Mpu6500Temperature, DependsOnTheVariant) {
  EXPECT_EQ(decode_temperature(kMpu6500, 0).degc(), 21.0F);
  EXPECT_NEAR(decode_temperature(kMpu6500, 3339).degc(), 31.0F, 1e-3F);
  EXPECT_EQ(decode_temperature(kMpu6050, 0).degc(), 36.53F);
  EXPECT_NEAR(decode_temperature(kMpu6050, -3400).degc(), 26.53F, 1e-4F);
  EXPECT_NEAR(decode_temperature(kMpu6050, -521).degc(), 35.0F, 0.01F) << "of the data sheet";
  EXPECT_NEAR(decode_temperature(kMpu6500, -32768).degc(), -77.1F, 0.1F);
}

TEST(Mpu6500FifoLevel, CountsSamplesAndWhatIsLeftOver) {
  EXPECT_EQ(decode_fifo_level(kMpu6500, 0x00, 0x00).frames, 0);
  EXPECT_EQ(decode_fifo_level(kMpu6500, 0x01, 0x02).frames, 43);
  EXPECT_TRUE(decode_fifo_level(kMpu6500, 0x01, 0x02).is_whole);
  EXPECT_FALSE(decode_fifo_level(kMpu6500, 0x00, 0x05).is_whole);
}

TEST(Mpu6500FifoLevel, KeepsRoomForThreeSamples) {
  EXPECT_FALSE(decode_fifo_level(kMpu6500, 0x01, 0xEC).is_overrun) << "492 bytes, 82 samples";
  EXPECT_TRUE(decode_fifo_level(kMpu6500, 0x01, 0xF2).is_overrun) << "498 bytes";
  EXPECT_FALSE(decode_fifo_level(kMpu6050, 0x01, 0xF2).is_overrun);
  EXPECT_TRUE(decode_fifo_level(kMpu6050, 0x03, 0xF0).is_overrun);
}

TEST(Mpu6500FifoLevel, OfAFullFifoIsNeverWhole) {
  EXPECT_FALSE(decode_fifo_level(kMpu6500, 0x02, 0x00).is_whole);
  EXPECT_FALSE(decode_fifo_level(kMpu6050, 0x04, 0x00).is_whole);
  EXPECT_TRUE(decode_fifo_level(kMpu6500, 0x02, 0x00).is_plausible);
  EXPECT_FALSE(decode_fifo_level(kMpu6500, 0x02, 0x01).is_plausible);
  EXPECT_FALSE(decode_fifo_level(kMpu6050, 0xFF, 0xFF).is_plausible);
}

TEST(Mpu6500FifoLevel, WithAFlippedBitIsNeverWhole) {
  for (unsigned samples = 0; samples <= 82; ++samples) {
    for (unsigned bit = 0; bit < 16; ++bit) {
      const unsigned bytes = (samples * 6U) ^ (1U << bit);
      EXPECT_FALSE(decode_fifo_level(kMpu6500, static_cast<std::uint8_t>(bytes >> 8U),
                                     static_cast<std::uint8_t>(bytes & 0xFFU))
                       .is_whole);
    }
  }
}

TEST(Mpu6500Part, TakesItsOwnAnswerAndWhatIsSoldAsAnMpu6500) {
  for (const auto identity :
       std::to_array<std::uint8_t>({0x68, 0x70, 0x71, 0x72, 0x73, 0x74, 0x98})) {
    EXPECT_TRUE(takes(Part::mpu6500, identity)) << int{identity};
    EXPECT_EQ(takes(Part::icm20689, identity), identity == 0x98);
    EXPECT_FALSE(takes(Part::icm20602, identity));
  }
  EXPECT_FALSE(takes(Part::mpu6500, 0x12));
  EXPECT_FALSE(takes(Part::mpu6500, 0x19));
  EXPECT_TRUE(takes(Part::icm20602, 0x12));
  EXPECT_FALSE(takes(Part::icm20602, 0x19));
  EXPECT_TRUE(takes(Part::mpu6886, 0x19));
}

TEST(Icm20602FifoLevel, IsInSamplesOfEightOrFourteenBytes) {
  const Variant& chip = variant_of(Part::icm20602);
  EXPECT_EQ(decode_fifo_level(chip, 0x00, 0x18).frames, 3);
  EXPECT_TRUE(decode_fifo_level(chip, 0x00, 0x18).is_whole);
  EXPECT_FALSE(decode_fifo_level(chip, 0x00, 0x1C).is_whole);
  EXPECT_TRUE(decode_fifo_level(chip, 0x00, 0x1C, kLongSampleBytes).is_whole);
  EXPECT_FALSE(decode_fifo_level(chip, 0x03, 0xD8).is_overrun) << "984 bytes";
  EXPECT_TRUE(decode_fifo_level(chip, 0x03, 0xE0).is_overrun) << "992 bytes";
  EXPECT_FALSE(decode_fifo_level(chip, 0x03, 0xF8).is_plausible);
}

TEST(Icm20602Mark, IsTheTemperatureWithin5Degrees) {
  EXPECT_TRUE(is_marked(0, 1634));
  EXPECT_TRUE(is_marked(1634, 0));
  EXPECT_FALSE(is_marked(0, 1635));
  EXPECT_FALSE(is_marked(-32768, 32767));
}

TEST(Mpu6500SamplePeriod, IsThatOfTheNamedRate) {
  EXPECT_EQ(sample_period(OutputDataRate::hz_12_5), core::Duration::milliseconds(80));
  EXPECT_EQ(sample_period(OutputDataRate::hz_25), core::Duration::milliseconds(40));
  EXPECT_EQ(sample_period(OutputDataRate::hz_50), core::Duration::milliseconds(20));
  EXPECT_EQ(sample_period(OutputDataRate::hz_100), core::Duration::milliseconds(10));
  EXPECT_EQ(sample_period(OutputDataRate::hz_125), core::Duration::milliseconds(8));
  EXPECT_EQ(sample_period(OutputDataRate::hz_200), core::Duration::milliseconds(5));
  EXPECT_EQ(sample_period(OutputDataRate::hz_250), core::Duration::milliseconds(4));
  EXPECT_EQ(sample_period(OutputDataRate::hz_500), core::Duration::milliseconds(2));
  EXPECT_EQ(sample_period(OutputDataRate::hz_1000), core::Duration::milliseconds(1));
}

}  // namespace
}  // namespace zerorate::drivers::mpu6500

namespace zerorate::drivers {
namespace {

using core::deg_per_s;
using hal::testing::Fault;
using mpu6500::Mode;
using mpu6500::Settings;
using Rig = support::GyroRig<support::OverSpi<support::Mpu6500>>;
using I2cRig = support::GyroRig<support::OverI2c<support::Mpu6050>>;

constexpr Settings kFifo{.mode = Mode::fifo};
constexpr support::Rates kOneTwoThree{deg_per_s(1.0F), deg_per_s(2.0F), deg_per_s(3.0F)};

void expect_one_two_three(const GyroSample& sample) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sample.rate[axis].in(deg_per_s), static_cast<float>(axis + 1), 0.005F);
  }
}

TEST(Mpu6500, ConfiguresTheRegistersThatTheDatasheetNames) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.chip.read_register(0x19), 0x09);  // SMPLRT_DIV: 1 kHz by 10
  EXPECT_EQ(rig.chip.read_register(0x1A), 0x03);  // CONFIG: 41 Hz
  EXPECT_EQ(rig.chip.read_register(0x1B), 0x00);  // GYRO_CONFIG: 250 deg/s
  EXPECT_EQ(rig.chip.read_register(0x23), 0x70);  // FIFO_EN: the gyro's axes
  EXPECT_EQ(rig.chip.read_register(0x37), 0x00);  // INT_PIN_CFG: pulsed, push-pull, active high
  EXPECT_EQ(rig.chip.read_register(0x38), 0x10);  // INT_ENABLE: overflow
  EXPECT_EQ(rig.chip.read_register(0x6A), 0x50);  // USER_CTRL: FIFO on, I2C off
  EXPECT_EQ(rig.chip.read_register(0x6B), 0x01);  // PWR_MGMT_1: awake, clock of the gyro
  EXPECT_EQ(rig.chip.read_register(0x6C), 0x38);  // PWR_MGMT_2: accelerometer off
  for (std::uint8_t offset = 0x13; offset <= 0x18; ++offset) {
    EXPECT_EQ(rig.chip.read_register(offset), 0x00) << "the bias is to be the sensor's own";
  }
}

TEST(Mpu6500, SamplesAtTheRateThatItSays) {
  using enum mpu6500::OutputDataRate;
  for (const auto rate : {hz_12_5, hz_25, hz_50, hz_100, hz_125, hz_200, hz_250, hz_500, hz_1000}) {
    Rig rig{{.rate = rate}};
    ASSERT_TRUE(rig.start());
    EXPECT_EQ(rig.chip.sample_period(), rig.driver.sample_period());
  }
}

TEST(Mpu6500OverI2c, LeavesTheChipsI2cOn) {
  for (const Settings& settings : {Settings{}, kFifo}) {
    I2cRig rig{settings};
    ASSERT_TRUE(rig.start_and_settle());
    EXPECT_EQ(rig.chip.read_register(0x6A) & 0x10U, 0U);
    rig.chip.upset(0x3A, 0x10);  // an overflow, after which the FIFO is emptied
    std::array<GyroSample, 4> out{};
    (void)rig.read(out);
    EXPECT_EQ(rig.chip.read_register(0x6A) & 0x10U, 0U);
  }
}

TEST(Mpu6500, TakesItsRelativesAndSaysTheTemperatureOfThoseItKnows) {
  for (const std::uint8_t identity : support::Mpu6500::kIdentities) {
    Rig rig{{}, {}, identity};
    ASSERT_TRUE(rig.start_and_settle()) << int{identity};
    rig.sample(kOneTwoThree);
    std::array<GyroSample, 1> out{};
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    expect_one_two_three(out[0]);
    EXPECT_EQ(out[0].has_temperature, identity != 0x72) << int{identity};
  }
}

TEST(Mpu6500, RefusesAChipThatBecomesAnotherWhileItStarts) {
  Rig rig;
  EXPECT_EQ(rig.driver.start(rig.clock.now()).error().code, DriverErrorCode::not_ready);
  rig.clock.advance(core::Duration::milliseconds(100));
  rig.faults.inject({.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls(), .bit = 0});
  EXPECT_EQ(rig.driver.start(rig.clock.now()).error(),
            (DriverError{DriverErrorCode::wrong_identity, {}, 0x75}));
  EXPECT_TRUE(rig.start());
}

TEST(Icm20602, HasTheSwitchOfI2cInARegisterOfItsOwn) {
  support::GyroRig<support::OverSpi<support::Icm20602>> spi{{.mode = Mode::fifo}};
  ASSERT_TRUE(spi.start());
  EXPECT_EQ(spi.chip.read_register(0x70), 0x40);  // I2C_IF
  EXPECT_EQ(spi.chip.read_register(0x6A), 0x40);  // USER_CTRL: FIFO on
  EXPECT_EQ(spi.chip.read_register(0x23), 0x10);  // FIFO_EN: gyro and temperature
  EXPECT_EQ(spi.chip.read_register(0x1A), 0x03);  // CONFIG: 41 Hz; bit 7 is cleared
  support::GyroRig<support::OverI2c<support::Icm20602>> i2c;
  ASSERT_TRUE(i2c.start());
  EXPECT_EQ(i2c.chip.read_register(0x70), 0x00);
}

TEST(Icm20602Fifo, GivesNoShiftedSampleAfterLostBytes) {
  for (int lost = 1; lost < 8; ++lost) {
    support::GyroRig<support::OverSpi<support::Icm20602>> rig{{.mode = Mode::fifo}};
    ASSERT_TRUE(rig.start_and_settle());
    constexpr auto kWarm = core::Temperature::from_degc(40.0F);
    for (int i = 0; i < 3; ++i) rig.sample(kOneTwoThree, kWarm);
    for (int i = 0; i < lost; ++i) rig.chip.read_register(0x74);
    // Other bytes take their place, so that the level is whole.
    for (int i = 0; i < lost; ++i) rig.chip.write_register(0x74, 0x15);
    std::array<GyroSample, 8> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << lost;
    EXPECT_EQ(read.error().code, DriverErrorCode::corrupt_data);
    ASSERT_EQ(rig.read(out).value_or(9), 0U) << "it is emptied";
    rig.sample(kOneTwoThree, kWarm);
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    expect_one_two_three(out[0]);
  }
}

TEST(Mpu6500Fifo, TellsOfTheGapWhereABurstTookPartOfASample) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample(kOneTwoThree);
  rig.sample(kOneTwoThree);
  std::array<std::uint8_t, 5> part{};
  SpiRegisters registers{rig.bus};
  ASSERT_TRUE(registers.read(0x74, part));  // somebody took five bytes
  std::array<GyroSample, 4> out{};
  const auto shifted = rig.read(out);
  ASSERT_FALSE(shifted);
  EXPECT_EQ(shifted.error(), (DriverError{DriverErrorCode::fifo_overrun, {}, 0x72}));
  rig.sample(kOneTwoThree);
  ASSERT_EQ(rig.read(out).value_or(0), 1U);
  expect_one_two_three(out[0]);
  EXPECT_EQ(out[0].time, rig.clock.now());
}

TEST(Mpu6500Fifo, GivesNoShiftedSampleAfterAnyNumberOfLostBytes) {
  for (std::size_t lost = 1; lost < 12; ++lost) {
    Rig rig{kFifo};
    ASSERT_TRUE(rig.start_and_settle());
    for (int i = 0; i < 5; ++i) rig.sample(kOneTwoThree);
    std::array<std::uint8_t, 12> bytes{};
    SpiRegisters registers{rig.bus};
    ASSERT_TRUE(registers.read(0x74, std::span{bytes}.first(lost)));
    std::size_t given = 0;
    for (int i = 0; i < 10; ++i) {
      rig.sample(kOneTwoThree);
      std::array<GyroSample, 16> out{};
      const std::size_t count = rig.read(out).value_or(0);
      for (std::size_t k = 0; k < count; ++k) expect_one_two_three(out[k]);
      given += count;
    }
    EXPECT_GE(given, 9U) << lost;
  }
}

TEST(Mpu6500Fifo, GivesNoShiftedSampleAfterAnOverflow) {
  for (const int count : {83, 84, 85, 86, 87, 100, 171, 500}) {
    Rig rig{kFifo};
    ASSERT_TRUE(rig.start_and_settle());
    for (int i = 0; i < count; ++i) rig.sample(kOneTwoThree);
    std::array<GyroSample, 16> out{};
    const auto read = rig.read(out);
    ASSERT_FALSE(read) << count;
    EXPECT_EQ(read.error().code, DriverErrorCode::fifo_overrun);
    rig.sample(kOneTwoThree);
    ASSERT_EQ(rig.read(out).value_or(0), 1U);
    expect_one_two_three(out[0]);
  }
}

TEST(Mpu6500Fifo, SeesAnOverflowWhoseFlagGotLost) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 100; ++i) rig.sample(kOneTwoThree);
  EXPECT_EQ(rig.chip.read_register(0x3A) & 0x10U, 0x10U);  // reading it clears it
  std::array<GyroSample, 16> out{};
  EXPECT_EQ(rig.read(out).error().code, DriverErrorCode::fifo_overrun);
}

TEST(Mpu6500Fifo, OverflowsInAReadAreFoundBeforeTheNextSample) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  for (int i = 0; i < 82; ++i) rig.sample(kOneTwoThree);
  // Three samples come between the level and the data.
  rig.faults.before(rig.faults.calls() + 2, [&] {
    for (int i = 0; i < 3; ++i) rig.sample(kOneTwoThree);
  });
  std::array<GyroSample, 16> out{};
  ASSERT_EQ(rig.read(out).value_or(0), 16U);
  for (const GyroSample& sample : out) expect_one_two_three(sample);
}

TEST(Mpu6500Fifo, LooksTwiceBeforeItReportsAShift) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample(kOneTwoThree);
  rig.faults.inject({.kind = Fault::Kind::flipped_bit, .first = rig.faults.calls() + 1, .bit = 10});
  std::array<GyroSample, 4> out{};
  EXPECT_EQ(rig.read(out).value_or(0), 1U);
  expect_one_two_three(out[0]);
}

TEST(Mpu6500Fifo, IsEmptiedAfterABrokenBurst) {
  Rig rig{kFifo};
  ASSERT_TRUE(rig.start_and_settle());
  rig.sample(kOneTwoThree);
  rig.faults.inject({.kind = Fault::Kind::after_effect,
                     .first = rig.faults.calls() + 2,
                     .calls = 3,
                     .error = hal::BusError::timeout});
  std::array<GyroSample, 4> out{};
  EXPECT_EQ(rig.read(out).error().code, DriverErrorCode::bus_failed);
  EXPECT_EQ(rig.read(out).error().code, DriverErrorCode::bus_failed);
  EXPECT_EQ(rig.read(out).error().code, DriverErrorCode::bus_failed);
  EXPECT_EQ(rig.read(out).value_or(9), 0U);
  rig.sample(kOneTwoThree);
  ASSERT_EQ(rig.read(out).value_or(0), 1U);
  expect_one_two_three(out[0]);
}

TEST(Mpu6500OnScriptedSpi, AsksForTheIdentityAndResetsInTwoSteps) {
  using hal::testing::reads;
  using hal::testing::writes;
  hal::testing::ScriptedSpiDevice spi;
  Mpu6500 driver{SpiRegisters{spi}};
  core::Instant now{};
  spi.expect({writes({0xF5}), reads({0x70})});
  spi.expect({writes({0x6B, 0x80})});
  EXPECT_EQ(driver.start(now).error().code, DriverErrorCode::not_ready);
  now = now + core::Duration::milliseconds(99);
  EXPECT_EQ(driver.start(now).error().code, DriverErrorCode::not_ready);
  now = now + core::Duration::milliseconds(1);
  spi.expect({writes({0xF5}), reads({0x70})});
  spi.expect({writes({0x6B, 0x01})});
  spi.expect({writes({0x68, 0x07})});
  EXPECT_EQ(driver.start(now).error().code, DriverErrorCode::not_ready);
}

/// A write to the register, which is reserved in the last two, would kill some of them.
TEST(Mpu6500OnScriptedSpi, ResetsTheSignalPathsOfThoseThatNeedIt) {
  using hal::testing::reads;
  using hal::testing::writes;
  struct Case {
    std::uint8_t identity;
    bool is_written;
  };
  for (const Case& one :
       {Case{0x68, true}, Case{0x71, true}, Case{0x72, false}, Case{0x98, false}}) {
    hal::testing::ScriptedSpiDevice spi;
    Mpu6500 driver{SpiRegisters{spi}};
    spi.expect({writes({0xF5}), reads({one.identity})});
    spi.expect({writes({0x6B, 0x80})});
    EXPECT_EQ(driver.start({}).error().code, DriverErrorCode::not_ready);
    spi.expect({writes({0xF5}), reads({one.identity})});
    spi.expect({writes({0x6B, 0x01})});
    if (one.is_written) spi.expect({writes({0x68, 0x07})});
    const auto later = core::Instant{} + core::Duration::milliseconds(100);
    EXPECT_EQ(driver.start(later).error().code, DriverErrorCode::not_ready);
  }
}

}  // namespace
}  // namespace zerorate::drivers

/// @file
/// The simulated chip against what is known of the real one, register by register.

#include "hal/sim/mpu6500.hpp"

#include <gtest/gtest.h>

#include <array>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;
constexpr core::Temperature kRoom21 = core::Temperature::from_degc(21.0F);

std::int16_t read_word(SimulatedMpu6500& chip, std::uint8_t high_address) {
  const unsigned high = chip.read_register(high_address);
  const unsigned low = chip.read_register(static_cast<std::uint8_t>(high_address + 1U));
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
}

class SimulatedMpu6500Test : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::seconds(1)); }
  std::int16_t read_word(std::uint8_t high_address) { return sim::read_word(chip_, high_address); }
  void measure_x(float dps) { chip_.measure({deg_per_s(dps), {}, {}}, kRoom21); }
  void enable_fifo(std::uint8_t content = 0x70) {
    chip_.write_register(0x23, content);
    chip_.write_register(0x6A, 0x40);
  }

  SimulatedClock clock_;
  SimulatedMpu6500 chip_{clock_};
};

TEST_F(SimulatedMpu6500Test, RunsFromPowerOnAndTheMpu6050Sleeps) {
  EXPECT_EQ(chip_.read_register(0x75), 0x70);
  EXPECT_EQ(chip_.read_register(0x6B), 0x01);
  EXPECT_TRUE(chip_.is_powered());
  SimulatedMpu6050 older(clock_);
  EXPECT_EQ(older.read_register(0x75), 0x68);
  EXPECT_EQ(older.read_register(0x6B), 0x40);
  EXPECT_FALSE(older.is_powered());
  EXPECT_EQ(older.read_register(0x00) & 0x01, 0x01) << "OTP_BNK_VLD";
}

TEST_F(SimulatedMpu6500Test, MagnetometerAnswersByTheSlave) {
  SimulatedMpu9250 chip(clock_);
  EXPECT_EQ(chip.read_register(0x75), 0x71);
  const auto ask = [&](std::uint8_t address, std::uint8_t from, std::uint8_t control) {
    chip.write_register(0x25, address);
    chip.write_register(0x26, from);
    chip.write_register(0x27, control);
    chip.write_register(0x6A, 0x20);
    chip.write_register(0x6A, 0x00);
    return chip.read_register(0x36) & 0x01;  // I2C_SLV0_NACK
  };
  EXPECT_EQ(ask(0x8C, 0x00, 0x81), 0);
  EXPECT_EQ(chip.read_register(0x49), 0x48);
  EXPECT_EQ(ask(0x8C, 0x0F, 0x85), 0) << "three factors of 1, and what is not modelled around them";
  EXPECT_EQ(chip.read_register(0x49), 0);
  for (const int at : {0x4A, 0x4B, 0x4C}) {
    EXPECT_EQ(chip.read_register(static_cast<std::uint8_t>(at)), 128);
  }
  EXPECT_EQ(chip.read_register(0x4D), 0);
  EXPECT_EQ(ask(0x0C, 0x0B, 0x81), 0) << "written to";
  EXPECT_EQ(ask(0x8D, 0x00, 0x81), 1) << "nobody is there";
  EXPECT_EQ(ask(0x8C, 0x00, 0x01), 1) << "switched off: the status stays";
}

TEST_F(SimulatedMpu6500Test, HasFourRangesAndClips) {
  float full_scale_dps = 250.0F;
  for (unsigned code = 0; code < 4; ++code, full_scale_dps *= 2.0F) {
    chip_.write_register(0x1B, static_cast<std::uint8_t>(code << 3U));
    measure_x(full_scale_dps / 4.0F);
    EXPECT_EQ(read_word(0x43), 8192) << code;
    measure_x(full_scale_dps * 2.0F);
    EXPECT_EQ(read_word(0x43), 32767);
    measure_x(-full_scale_dps * 2.0F);
    EXPECT_EQ(read_word(0x43), -32768);
  }
}

TEST_F(SimulatedMpu6500Test, ThermometersDiffer) {
  chip_.measure({}, core::Temperature::from_degc(31.0F));
  EXPECT_EQ(read_word(0x41), 3339);
  SimulatedMpu6050 older(clock_);
  older.write_register(0x6B, 0x01);
  older.measure({}, core::Temperature::from_degc(35.0F));
  EXPECT_EQ(sim::read_word(older, 0x41), -520);  // -521 in the data sheet
}

TEST_F(SimulatedMpu6500Test, TheThermometerCanBeOff) {
  chip_.write_register(0x6B, 0x09);
  chip_.measure({}, core::Temperature::from_degc(31.0F));
  EXPECT_EQ(read_word(0x41), 0);
}

TEST_F(SimulatedMpu6500Test, AddsTheOffsetsInEveryRange) {
  chip_.write_register(0x15, 0x01);  // YG_OFFSET: 256 counts at 1000 deg/s, 7.8 deg/s
  measure_x(1.0F);
  EXPECT_EQ(read_word(0x43), 131);
  EXPECT_EQ(read_word(0x45), 1024);
  chip_.write_register(0x1B, 0x10);
  measure_x(1.0F);
  EXPECT_EQ(read_word(0x45), 256);
  chip_.write_register(0x15, 0xFF);
  measure_x(1.0F);
  EXPECT_EQ(read_word(0x45), -256);
}

TEST_F(SimulatedMpu6500Test, DataReadyFallsWhenTheStatusIsRead) {
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x3B), 0x00);
  EXPECT_EQ(chip_.read_register(0x3A), 0x01);
  EXPECT_EQ(chip_.read_register(0x3A), 0x00);
  chip_.write_register(0x37, 0x10);  // INT_ANYRD_2CLEAR
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x43), 0x00);
  EXPECT_EQ(chip_.read_register(0x3A), 0x00);
}

TEST_F(SimulatedMpu6500Test, PulsesItsPinOrHoldsItUntilRead) {
  measure_x(1.0F);
  EXPECT_FALSE(chip_.interrupt().take_edge()) << "not enabled";
  chip_.write_register(0x38, 0x01);
  measure_x(1.0F);
  EXPECT_TRUE(chip_.interrupt().take_edge());
  EXPECT_FALSE(chip_.interrupt().level());
  chip_.write_register(0x37, 0x20);  // LATCH_INT_EN
  measure_x(1.0F);
  EXPECT_TRUE(chip_.interrupt().level());
  (void)chip_.read_register(0x3A);
  EXPECT_FALSE(chip_.interrupt().level());
  chip_.write_register(0x37, 0xA0);  // active low
  EXPECT_TRUE(chip_.interrupt().level());
  measure_x(1.0F);
  EXPECT_FALSE(chip_.interrupt().level());
}

TEST_F(SimulatedMpu6500Test, FifoHoldsBytesInTheOrderOfTheRegisters) {
  enable_fifo(0xF8);
  chip_.measure({deg_per_s(10.0F), deg_per_s(-10.0F), {}}, core::Temperature::from_degc(31.0F));
  EXPECT_EQ(read_word(0x72), 14);
  // 1 g along z, 16384 counts in the range of 2 g; 3339 counts; 1311 of rate.
  constexpr std::array<std::uint8_t, 14> kExpected{0,    0,    0,    0,    0x40, 0, 0x0D,
                                                   0x0B, 0x05, 0x1F, 0xFA, 0xE1, 0, 0};
  for (const std::uint8_t byte : kExpected) EXPECT_EQ(chip_.read_register(0x74), byte);
  EXPECT_EQ(read_word(0x72), 0);
  EXPECT_EQ(chip_.read_register(0x74), 0x00) << "the last byte again";
}

TEST_F(SimulatedMpu6500Test, MeasuresSpecificForceInFourRanges) {
  chip_.set_specific_force({core::standard_gravity(-1.0F), {}, core::standard_gravity(30.0F)});
  constexpr std::array<std::int16_t, 4> kRawOf1g{16384, 8192, 4096, 2048};
  for (std::size_t code = 0; code < kRawOf1g.size(); ++code) {
    chip_.write_register(0x1C, static_cast<std::uint8_t>(code << 3U));
    measure_x(0.0F);
    EXPECT_EQ(read_word(0x3B), -kRawOf1g.at(code));
    EXPECT_EQ(read_word(0x3D), 0);
    EXPECT_EQ(read_word(0x3F), 32767) << "clipped";
  }
  chip_.write_register(0x6C, 0x20);  // x stands by
  measure_x(0.0F);
  EXPECT_EQ(read_word(0x3B), 0);
  EXPECT_EQ(read_word(0x3F), 32767);
}

TEST_F(SimulatedMpu6500Test, FullFifoLosesBytesAndIsShifted) {
  enable_fifo();
  for (int i = 0; i < 85; ++i) measure_x(10.0F);
  EXPECT_EQ(read_word(0x72), 510);
  EXPECT_EQ(chip_.read_register(0x3A), 0x01);
  measure_x(10.0F);
  EXPECT_EQ(read_word(0x72), 512);
  EXPECT_EQ(chip_.read_register(0x3A), 0x11);
  EXPECT_EQ(chip_.read_register(0x74), 0x00) << "the y of what was the oldest";
}

TEST_F(SimulatedMpu6500Test, AFullFifoInFifoModeStops) {
  enable_fifo();
  chip_.write_register(0x1A, 0x41);
  for (int i = 0; i < 100; ++i) measure_x(10.0F);
  EXPECT_EQ(read_word(0x72), 512);
  EXPECT_EQ(chip_.read_register(0x3A), 0x11);
  EXPECT_EQ(chip_.read_register(0x74), 0x05);
}

TEST_F(SimulatedMpu6500Test, FifoOfTheMpu6050HoldsTwiceAsMuch) {
  SimulatedMpu6050 older(clock_);
  older.write_register(0x6B, 0x01);
  older.write_register(0x23, 0x70);
  older.write_register(0x6A, 0x40);
  for (int i = 0; i < 170; ++i) older.measure({}, kRoom21);
  EXPECT_EQ(sim::read_word(older, 0x72), 1020);
  EXPECT_EQ(older.read_register(0x3A), 0x01);
  older.measure({}, kRoom21);
  EXPECT_EQ(older.read_register(0x3A), 0x11);
}

TEST_F(SimulatedMpu6500Test, FifoIsEmptiedWhileItIsOff) {
  enable_fifo();
  measure_x(10.0F);
  chip_.write_register(0x6A, 0x44);
  EXPECT_EQ(read_word(0x72), 6) << "it is on";
  chip_.write_register(0x6A, 0x04);
  EXPECT_EQ(read_word(0x72), 0);
  EXPECT_EQ(chip_.read_register(0x6A), 0x00) << "FIFO_RST clears itself";
  measure_x(10.0F);
  EXPECT_EQ(read_word(0x72), 0);
}

TEST_F(SimulatedMpu6500Test, TheLevelIsLatchedWhenItsHighByteIsRead) {
  enable_fifo();
  measure_x(10.0F);
  EXPECT_EQ(chip_.read_register(0x72), 0x00);
  measure_x(10.0F);
  EXPECT_EQ(chip_.read_register(0x73), 6);
  EXPECT_EQ(read_word(0x72), 12);
}

TEST_F(SimulatedMpu6500Test, ResetTakesATenthOfASecond) {
  chip_.write_register(0x1B, 0x18);
  chip_.write_register(0x6B, 0x80);
  EXPECT_FALSE(chip_.is_powered());
  chip_.write_register(0x1B, 0x18);  // refused: still in reset
  EXPECT_EQ(chip_.read_register(0x1B), 0x00);
  clock_.advance(core::Duration::milliseconds(100));
  EXPECT_EQ(chip_.read_register(0x6B), 0x01);
  chip_.write_register(0x1B, 0x18);
  EXPECT_EQ(chip_.read_register(0x1B), 0x18);
}

TEST_F(SimulatedMpu6500Test, ResetOfTheSignalPathsClearsTheOutputs) {
  chip_.measure({deg_per_s(1.0F), {}, {}}, core::Temperature::from_degc(31.0F));
  chip_.write_register(0x68, 0x04);
  EXPECT_EQ(read_word(0x43), 0);
  EXPECT_EQ(read_word(0x41), 3339);
  chip_.write_register(0x68, 0x01);
  EXPECT_EQ(read_word(0x41), 0);
  EXPECT_EQ(chip_.read_register(0x68), 0x00);
  measure_x(1.0F);
  chip_.write_register(0x6A, 0x01);  // SIG_COND_RST
  EXPECT_EQ(read_word(0x43), 0);
  EXPECT_EQ(chip_.read_register(0x6A), 0x00);
}

TEST_F(SimulatedMpu6500Test, SleepsAndStandsByAxisByAxis) {
  const auto one_each = [&] { chip_.measure({deg_per_s(1), deg_per_s(1), deg_per_s(1)}, kRoom21); };
  chip_.write_register(0x6C, 0x02);  // y
  one_each();
  EXPECT_EQ(read_word(0x43), 131);
  EXPECT_EQ(read_word(0x45), 0);
  EXPECT_EQ(read_word(0x47), 131);
  chip_.write_register(0x6C, 0x07);
  EXPECT_FALSE(chip_.is_powered());
  one_each();
  EXPECT_EQ(read_word(0x43), 0);
  chip_.write_register(0x6C, 0x00);
  chip_.write_register(0x6B, 0x41);
  EXPECT_EQ(chip_.sample_period(), core::Duration{});
  (void)chip_.read_register(0x3A);
  one_each();
  EXPECT_EQ(chip_.read_register(0x3A), 0x00);
}

TEST_F(SimulatedMpu6500Test, TheFirst35MillisecondsAreOff) {
  chip_.write_register(0x6B, 0x41);
  chip_.write_register(0x6B, 0x01);
  clock_.advance(core::Duration::microseconds(17'500));
  measure_x(0.0F);
  EXPECT_NEAR(read_word(0x43), 10.0 * 131.072, 1.0);  // half of 20 deg/s
  clock_.advance(core::Duration::microseconds(17'500));
  measure_x(0.0F);
  EXPECT_EQ(read_word(0x43), 0);
}

TEST_F(SimulatedMpu6500Test, PeriodIsThatOfDividerAndFilter) {
  chip_.write_register(0x19, 9);
  EXPECT_EQ(chip_.sample_period(), core::Duration::microseconds(125)) << "without a divider";
  chip_.write_register(0x1A, 3);
  EXPECT_EQ(chip_.sample_period(), core::Duration::milliseconds(10));
  chip_.write_register(0x1B, 0x01);
  EXPECT_EQ(chip_.sample_period(), core::Duration::nanoseconds(31'250)) << "round the filter";
  SimulatedMpu6050 older(clock_);
  older.write_register(0x6B, 0x01);
  older.write_register(0x19, 7);
  EXPECT_EQ(older.sample_period(), core::Duration::milliseconds(1)) << "8 kHz are divided";
}

TEST_F(SimulatedMpu6500Test, CountsWritesToAddressesThatAreNotListed) {
  chip_.write_register(0x75, 0x00);
  chip_.write_register(0x43, 0x01);
  for (const int used : {0x1D, 0x1F, 0x24, 0x25, 0x34, 0x63, 0x67, 0x69, 0x77, 0x7E}) {
    chip_.write_register(static_cast<std::uint8_t>(used), 0x01);
  }
  EXPECT_EQ(chip_.reserved_writes(), 0U);
  chip_.write_register(0x71, 0xFF);
  EXPECT_EQ(chip_.reserved_writes(), 1U);
  EXPECT_EQ(chip_.read_register(0x75), 0x70);
}

TEST_F(SimulatedMpu6500Test, TheIcm20602HasTheTemperatureInItsFifo) {
  SimulatedIcm20602 chip(clock_);
  EXPECT_EQ(chip.read_register(0x75), 0x12);
  EXPECT_EQ(chip.read_register(0x6B), 0x41);
  chip.write_register(0x6B, 0x01);
  chip.write_register(0x23, 0x10);
  chip.write_register(0x6A, 0x40);
  clock_.advance(core::Duration::seconds(1));
  chip.measure({deg_per_s(10.0F), {}, {}}, core::Temperature::from_degc(35.0F));
  EXPECT_EQ(sim::read_word(chip, 0x72), 8);
  chip.write_register(0x23, 0x18);
  chip.measure({}, core::Temperature::from_degc(25.0F));
  EXPECT_EQ(sim::read_word(chip, 0x72), 22);
  const auto pop = [&] {
    const unsigned high = chip.read_register(0x74);
    return static_cast<int>(high << 8U | chip.read_register(0x74));
  };
  EXPECT_EQ(pop(), 3268) << "temperature first";
  EXPECT_EQ(pop(), 1311);
  for (int i = 0; i < 200; ++i) chip.measure({}, kRoom21);
  EXPECT_EQ(sim::read_word(chip, 0x72), 1008);
  chip.write_register(0x24, 0x00);
  EXPECT_EQ(chip.reserved_writes(), 1U) << "no I2C master";
}

}  // namespace
}  // namespace zerorate::hal::sim

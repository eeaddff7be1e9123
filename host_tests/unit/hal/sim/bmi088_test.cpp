/// @file
/// The simulated chip against what is known of the real one, register by register.

#include "hal/sim/bmi088.hpp"

#include <gtest/gtest.h>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;

class SimulatedBmi088Test : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::seconds(1)); }
  std::int16_t read_word(std::uint8_t low_address) {
    const unsigned low = chip_.read_register(low_address);
    const unsigned high = chip_.read_register(static_cast<std::uint8_t>(low_address + 1U));
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
  }
  void measure_x(float dps) { chip_.measure({deg_per_s(dps), {}, {}}, {}); }

  SimulatedClock clock_;
  SimulatedBmi088 chip_{clock_};
};

TEST_F(SimulatedBmi088Test, HasTheResetValuesOfTheDatasheet) {
  for (std::uint8_t address = 0; address < 0x3F; ++address) {
    std::uint8_t expected = 0;
    if (address == 0x00) expected = 0x0F;  // GYRO_CHIP_ID
    if (address == 0x10) expected = 0x80;  // GYRO_BANDWIDTH
    if (address == 0x16) expected = 0x0F;  // INT3_INT4_IO_CONF
    if (address == 0x1E) expected = 0x08;  // FIFO_WM_ENABLE
    EXPECT_EQ(chip_.read_register(address), expected) << int{address};
  }
}

TEST_F(SimulatedBmi088Test, RoundsAndClips) {
  measure_x(1000.0F);  // 2000 deg/s after reset
  EXPECT_EQ(read_word(0x02), 16384);
  measure_x(-1.0F);
  EXPECT_EQ(read_word(0x02), -16);
  measure_x(2500.0F);
  EXPECT_EQ(read_word(0x02), 32767);
  measure_x(-2500.0F);
  EXPECT_EQ(read_word(0x02), -32768);
}

TEST_F(SimulatedBmi088Test, HasFiveRanges) {
  float full_scale_dps = 2000.0F;
  for (std::uint8_t code = 0; code < 5; ++code, full_scale_dps /= 2.0F) {
    chip_.write_register(0x0F, code);
    measure_x(full_scale_dps / 4.0F);
    EXPECT_EQ(read_word(0x02), 8192);
  }
}

TEST_F(SimulatedBmi088Test, DataReadyFallsByItself) {
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x0A), 0x80);
  EXPECT_EQ(chip_.read_register(0x0A), 0x80) << "not by reading";
  clock_.advance(core::Duration::microseconds(400));
  EXPECT_EQ(chip_.read_register(0x0A), 0x00);
}

TEST_F(SimulatedBmi088Test, FifoStopsWhenFullWithAnOverrun) {
  chip_.write_register(0x3E, 0x40);
  for (int i = 0; i < 100; ++i) measure_x(i == 0 ? 1000.0F : 0.0F);
  EXPECT_EQ(chip_.read_register(0x0E), 0x64);
  measure_x(0.0F);
  EXPECT_EQ(chip_.read_register(0x0E), 0xE4);
  EXPECT_EQ(chip_.read_register(0x0E), 0xE4) << "not cleared by reading";
  chip_.read_register(0x3F);
  EXPECT_EQ(chip_.read_register(0x3F), 0x40) << "the oldest was kept";
  chip_.write_register(0x3E, 0x40);
  EXPECT_EQ(chip_.read_register(0x0E), 0x00);
}

TEST_F(SimulatedBmi088Test, StreamKeepsTheLatest) {
  chip_.write_register(0x3E, 0x80);
  for (int i = 0; i < 101; ++i) measure_x(i == 1 ? 1000.0F : 0.0F);
  EXPECT_EQ(chip_.read_register(0x0E), 0xE4);
  chip_.read_register(0x3F);
  EXPECT_EQ(chip_.read_register(0x3F), 0x40);
}

TEST_F(SimulatedBmi088Test, SoftwareResetTakes30ms) {
  chip_.write_register(0x0F, 0x03);
  chip_.write_register(0x14, 0x01);
  EXPECT_EQ(chip_.read_register(0x0F), 0x03);
  chip_.write_register(0x14, 0xB6);
  EXPECT_EQ(chip_.read_register(0x0F), 0x00);
  EXPECT_FALSE(chip_.is_powered());
  clock_.advance(core::Duration::milliseconds(29));
  chip_.write_register(0x0F, 0x03);
  EXPECT_EQ(chip_.read_register(0x0F), 0x00);
  clock_.advance(core::Duration::milliseconds(1));
  EXPECT_TRUE(chip_.is_powered());
  chip_.write_register(0x0F, 0x03);
  EXPECT_EQ(chip_.read_register(0x0F), 0x03);
}

TEST_F(SimulatedBmi088Test, MeasuresNothingWhileSuspended) {
  chip_.write_register(0x11, 0x80);
  measure_x(1000.0F);
  EXPECT_EQ(read_word(0x02), 0);
  EXPECT_EQ(chip_.sample_period(), core::Duration{});
}

TEST_F(SimulatedBmi088Test, PeriodIsThatOfTheRate) {
  EXPECT_EQ(chip_.sample_period(), core::Duration::microseconds(500));
  chip_.write_register(0x10, 0x03);
  EXPECT_EQ(chip_.sample_period(), core::Duration::microseconds(2500));
  chip_.write_register(0x10, 0x07);
  EXPECT_EQ(chip_.sample_period(), core::Duration::milliseconds(10));
}

TEST_F(SimulatedBmi088Test, CountsWritesToAddressesThatAreNotListed) {
  chip_.write_register(0x00, 0x55);
  EXPECT_EQ(chip_.reserved_writes(), 0U);
  chip_.write_register(0x20, 0x55);
  EXPECT_EQ(chip_.reserved_writes(), 1U);
  EXPECT_EQ(chip_.read_register(0x00), 0x0F);
}

class SimulatedBmi088AccelerometerTest : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::seconds(1)); }
  void power_up() {
    die_.write_register(0x7D, 0x04);
    die_.write_register(0x7C, 0x00);
    clock_.advance(core::Duration::seconds(1));
  }
  std::int16_t read_word(std::uint8_t low_address) {
    const unsigned low = die_.read_register(low_address);
    const unsigned high = die_.read_register(static_cast<std::uint8_t>(low_address + 1U));
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
  }

  SimulatedClock clock_;
  SimulatedBmi088Accelerometer die_{clock_};
};

TEST_F(SimulatedBmi088AccelerometerTest, IsSuspendedAfterPowerOn) {
  EXPECT_EQ(die_.read_register(0x00), 0x1E);
  EXPECT_EQ(die_.read_register(0x40), 0xA8);
  EXPECT_EQ(die_.read_register(0x41), 0x01);
  EXPECT_EQ(die_.read_register(0x7C), 0x03);
  die_.measure_force();
  EXPECT_EQ(read_word(0x16), 0);
  power_up();
  die_.measure_force();
  EXPECT_EQ(read_word(0x16), 5461) << "1 g of 6";
}

TEST_F(SimulatedBmi088AccelerometerTest, HasFourRangesAndClips) {
  die_.set_specific_force({core::standard_gravity(-1.0F), {}, core::standard_gravity(30.0F)});
  power_up();
  constexpr std::array<std::int16_t, 4> kRawOf1g{10923, 5461, 2731, 1365};
  for (std::size_t code = 0; code < kRawOf1g.size(); ++code) {
    die_.write_register(0x41, static_cast<std::uint8_t>(code));
    die_.measure_force();
    EXPECT_EQ(read_word(0x12), -kRawOf1g.at(code));
    EXPECT_EQ(read_word(0x16), 32767);
  }
}

TEST_F(SimulatedBmi088AccelerometerTest, FifoHoldsFramesWithAHeader) {
  power_up();
  EXPECT_EQ(read_word(0x24), -32768) << "empty";
  die_.write_register(0x49, 0x50);
  die_.measure_force();
  die_.measure_force();
  EXPECT_EQ(read_word(0x24), 14);
  constexpr std::array<std::uint8_t, 7> kFrame{0x84, 0, 0, 0, 0, 0x55, 0x15};
  EXPECT_EQ(die_.read_register(0x26), 0x84);
  EXPECT_EQ(read_word(0x24), 14) << "a frame that was read in part comes again";
  for (const std::uint8_t byte : kFrame) EXPECT_EQ(die_.read_register(0x26), byte);
  EXPECT_EQ(read_word(0x24), 7);
  for (int i = 0; i < 200; ++i) die_.measure_force();
  EXPECT_EQ(read_word(0x24), 146 * 7);
  die_.write_register(0x7E, 0xB0);
  EXPECT_EQ(read_word(0x24), -32768) << "flushed";
}

TEST_F(SimulatedBmi088AccelerometerTest, SoftwareResetSuspendsIt) {
  power_up();
  die_.write_register(0x7E, 0xB6);
  EXPECT_FALSE(die_.is_powered());
  clock_.advance(core::Duration::milliseconds(1));
  EXPECT_EQ(die_.read_register(0x7D), 0x00);
  die_.write_register(0x50, 0x00);
  EXPECT_EQ(die_.reserved_writes(), 1U);
}

}  // namespace
}  // namespace zerorate::hal::sim

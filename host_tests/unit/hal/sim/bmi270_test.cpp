/// @file
/// The simulated chip against what is known of the real one, register by register.

#include "hal/sim/bmi270.hpp"

#include <gtest/gtest.h>

#include <array>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;

class SimulatedBmi270Test : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::seconds(1)); }
  void load(std::span<const std::uint8_t> file) {
    chip_.write_register(0x59, 0x00);
    chip_.write_register(0x5B, 0x00);
    chip_.write_register(0x5C, 0x00);
    for (const std::uint8_t byte : file) chip_.write_register(0x5E, byte);
    chip_.write_register(0x59, 0x01);
  }
  void power_up() {
    chip_.write_register(0x7C, 0x00);
    load(SimulatedBmi270::config_file());
    clock_.advance(core::Duration::milliseconds(20));
    chip_.write_register(0x7D, 0x0E);
    clock_.advance(core::Duration::seconds(1));
  }
  void measure_x(float dps) {
    chip_.measure({deg_per_s(dps), {}, {}}, core::Temperature::from_degc(25.0F));
  }
  std::int16_t read_word(std::uint8_t low_address) {
    const unsigned low = chip_.read_register(low_address);
    const unsigned high = chip_.read_register(static_cast<std::uint8_t>(low_address + 1U));
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
  }
  int read_fifo() {
    const int low = chip_.read_register(0x26);
    return low + 256 * chip_.read_register(0x26);
  }

  SimulatedClock clock_;
  SimulatedBmi270 chip_{clock_};
};

TEST_F(SimulatedBmi270Test, SaysWhoItIsAndSavesPower) {
  EXPECT_EQ(chip_.read_register(0x00), 0x24);
  EXPECT_EQ(chip_.read_register(0x21), 0x00);
  EXPECT_EQ(chip_.read_register(0x42), 0xA9);
  EXPECT_EQ(chip_.read_register(0x7C), 0x03);
  chip_.write_register(0x7D, 0x0E);
  EXPECT_FALSE(chip_.is_powered()) << "without its file";
}

TEST_F(SimulatedBmi270Test, TakesItsFileInTwentyMilliseconds) {
  chip_.write_register(0x7C, 0x00);
  load(SimulatedBmi270::config_file());
  EXPECT_EQ(chip_.read_register(0x21), 0x00);
  clock_.advance(core::Duration::milliseconds(20));
  EXPECT_EQ(chip_.read_register(0x21), 0x01);
}

TEST_F(SimulatedBmi270Test, ReportsADamagedFile) {
  chip_.write_register(0x7C, 0x00);
  load(SimulatedBmi270::config_file().first(598));
  clock_.advance(core::Duration::milliseconds(20));
  EXPECT_EQ(chip_.read_register(0x21), 0x02);
}

TEST_F(SimulatedBmi270Test, TakesNoFileInPowerSave) {
  load(SimulatedBmi270::config_file());
  clock_.advance(core::Duration::milliseconds(20));
  EXPECT_EQ(chip_.read_register(0x21), 0x02);
  EXPECT_TRUE(chip_.loaded().empty());
}

TEST_F(SimulatedBmi270Test, AGapInTheFileIsSeen) {
  chip_.write_register(0x7C, 0x00);
  chip_.write_register(0x5B, 0x01);  // word 1
  chip_.write_register(0x5E, 0xA5);
  chip_.write_register(0x59, 0x01);
  clock_.advance(core::Duration::milliseconds(20));
  EXPECT_EQ(chip_.read_register(0x21), 0x02);
}

TEST_F(SimulatedBmi270Test, MeasuresInFiveRanges) {
  power_up();
  for (std::uint8_t code = 0; code < 5; ++code) {
    chip_.write_register(0x43, code);
    measure_x(100.0F);
    EXPECT_NEAR(read_word(0x12), 100.0 * 32768.0 * (1 << code) / 2000.0, 0.5);
  }
  EXPECT_EQ(read_word(0x22), 1024) << "2 degrees above 23";
}

TEST_F(SimulatedBmi270Test, MeasuresSpecificForceInFourRanges) {
  power_up();
  for (std::uint8_t code = 0; code < 4; ++code) {
    chip_.write_register(0x41, code);
    measure_x(0.0F);
    EXPECT_EQ(read_word(0x10), 16384 >> code);
  }
}

TEST_F(SimulatedBmi270Test, DataReadyFallsWhenTheDataAreRead) {
  power_up();
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x03), 0xD0);
  (void)read_word(0x12);
  EXPECT_EQ(chip_.read_register(0x03), 0x90);
  (void)read_word(0x0C);
  EXPECT_EQ(chip_.read_register(0x03), 0x10);
}

TEST_F(SimulatedBmi270Test, FifoDropsTheOldestOrStops) {
  power_up();
  chip_.write_register(0x49, 0x80);
  for (int i = 0; i < 342; ++i) measure_x(static_cast<float>(i));
  EXPECT_EQ(read_word(0x24), 2046);
  EXPECT_NEAR(read_fifo(), 16.384, 0.5) << "1 deg/s, the second";
  chip_.write_register(0x7E, 0xB0);
  EXPECT_EQ(read_word(0x24), 0);
  chip_.write_register(0x48, 0x01);
  for (int i = 0; i < 342; ++i) measure_x(static_cast<float>(i + 2));
  EXPECT_NEAR(read_fifo(), 32.768, 0.5) << "2 deg/s, the first";
}

TEST_F(SimulatedBmi270Test, RaisesInt1AtTheWatermark) {
  power_up();
  chip_.write_register(0x49, 0x80);
  chip_.write_register(0x46, 12);
  chip_.write_register(0x47, 0);
  chip_.write_register(0x53, 0x0A);
  chip_.write_register(0x58, 0x02);
  measure_x(0.0F);
  EXPECT_FALSE(chip_.interrupt().level());
  measure_x(0.0F);
  EXPECT_TRUE(chip_.interrupt().level());
}

TEST_F(SimulatedBmi270Test, ResetForgetsTheFile) {
  power_up();
  chip_.write_register(0x7E, 0xB6);
  EXPECT_FALSE(chip_.is_powered());
  chip_.write_register(0x43, 0x03);  // refused: still in reset
  EXPECT_EQ(chip_.read_register(0x43), 0x00);
  clock_.advance(core::Duration::milliseconds(2));
  EXPECT_TRUE(chip_.loaded().empty());
  chip_.write_register(0x30, 0x00);
  EXPECT_EQ(chip_.reserved_writes(), 0U);
  chip_.write_register(0x50, 0x00);
  EXPECT_EQ(chip_.reserved_writes(), 1U);
}

}  // namespace
}  // namespace zerorate::hal::sim

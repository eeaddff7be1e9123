/// @file
/// The simulated chip against what is known of the real one, register by register.

#include "hal/sim/bmi160.hpp"

#include <gtest/gtest.h>

#include <array>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;

class SimulatedBmi160Test : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::seconds(1)); }
  void power_up() {
    chip_.write_register(0x7E, 0x11);
    chip_.write_register(0x7E, 0x15);
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
  std::int16_t pop_word() {
    const unsigned low = chip_.read_register(0x24);
    return static_cast<std::int16_t>(low | (unsigned{chip_.read_register(0x24)} << 8U));
  }

  SimulatedClock clock_;
  SimulatedBmi160 chip_{clock_};
};

TEST_F(SimulatedBmi160Test, SaysWhoItIsAndSleeps) {
  EXPECT_EQ(chip_.read_register(0x00), 0xD1);
  EXPECT_EQ(chip_.read_register(0x03), 0x00);
  EXPECT_EQ(chip_.read_register(0x1B), 0x11);
  EXPECT_EQ(chip_.read_register(0x42), 0x28);
  measure_x(10.0F);
  EXPECT_EQ(read_word(0x0C), 0);
  EXPECT_EQ(read_word(0x20), -32768) << "no temperature yet";
}

TEST_F(SimulatedBmi160Test, WakesInEightyMilliseconds) {
  chip_.write_register(0x7E, 0x15);
  clock_.advance(core::Duration::milliseconds(79));
  EXPECT_EQ(chip_.read_register(0x03), 0x00);
  clock_.advance(core::Duration::milliseconds(1));
  EXPECT_EQ(chip_.read_register(0x03), 0x04);
  chip_.write_register(0x7E, 0x14);
  EXPECT_FALSE(chip_.is_powered());
}

TEST_F(SimulatedBmi160Test, MeasuresInFiveRanges) {
  power_up();
  for (std::uint8_t code = 0; code < 5; ++code) {
    chip_.write_register(0x43, code);
    measure_x(100.0F);
    EXPECT_NEAR(read_word(0x0C), 100.0 * 32768.0 * (1 << code) / 2000.0, 0.5);
  }
  EXPECT_EQ(read_word(0x20), 1024) << "2 degrees above 23";
}

TEST_F(SimulatedBmi160Test, MeasuresSpecificForceInFourRanges) {
  power_up();
  constexpr std::array<std::uint8_t, 4> kCodes{0x03, 0x05, 0x08, 0x0C};
  std::int16_t raw_of_1g = 16384;
  for (const std::uint8_t code : kCodes) {
    chip_.write_register(0x41, code);
    measure_x(0.0F);
    EXPECT_EQ(read_word(0x16), raw_of_1g);
    raw_of_1g = static_cast<std::int16_t>(raw_of_1g / 2);
  }
}

TEST_F(SimulatedBmi160Test, DataReadyFallsWhenTheDataAreRead) {
  power_up();
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x1B), 0xD1);
  (void)read_word(0x0C);
  EXPECT_EQ(chip_.read_register(0x1B), 0x91);
  (void)read_word(0x12);
  EXPECT_EQ(chip_.read_register(0x1B), 0x11);
}

// The kernel's driver runs both sensors and reads one.
TEST_F(SimulatedBmi160Test, Int1TellsOfEachSampleUnreadToo) {
  power_up();
  chip_.write_register(0x51, 0x10);
  chip_.write_register(0x53, 0x0A);
  chip_.write_register(0x56, 0x80);
  for (int sample = 0; sample < 3; ++sample) {
    measure_x(1.0F);
    EXPECT_TRUE(chip_.interrupt().take_edge().has_value()) << sample;
  }
  (void)read_word(0x0C);
  EXPECT_FALSE(chip_.interrupt().level());
}

TEST_F(SimulatedBmi160Test, FifoHasTheGyroInFrontAndDropsTheOldest) {
  power_up();
  chip_.write_register(0x47, 0xC0);
  measure_x(1.0F);
  EXPECT_EQ(read_word(0x22), 12);
  chip_.write_register(0x47, 0x80);
  EXPECT_EQ(read_word(0x22), 0);
  for (int i = 0; i < 171; ++i) measure_x(static_cast<float>(i));
  EXPECT_EQ(read_word(0x22), 1020);
  EXPECT_NEAR(pop_word(), 16.384, 0.5) << "1 deg/s, the second";
  chip_.write_register(0x7E, 0xB0);
  EXPECT_EQ(read_word(0x22), 0);
  EXPECT_EQ(chip_.read_register(0x24), 0x80);
}

TEST_F(SimulatedBmi160Test, RaisesInt1AtTheWatermark) {
  power_up();
  chip_.write_register(0x47, 0x80);
  chip_.write_register(0x46, 3);  // 12 bytes
  chip_.write_register(0x51, 0x40);
  chip_.write_register(0x53, 0x0A);
  chip_.write_register(0x56, 0x40);
  measure_x(0.0F);
  EXPECT_FALSE(chip_.interrupt().level());
  measure_x(0.0F);
  EXPECT_TRUE(chip_.interrupt().level());
}

TEST_F(SimulatedBmi160Test, ResetBringsEverythingBack) {
  power_up();
  chip_.write_register(0x43, 0x03);
  chip_.write_register(0x7E, 0xB6);
  EXPECT_FALSE(chip_.is_powered());
  chip_.write_register(0x43, 0x03);  // refused: still in reset
  EXPECT_EQ(chip_.read_register(0x43), 0x00);
  clock_.advance(core::Duration::milliseconds(1));
  chip_.write_register(0x43, 0x03);
  EXPECT_EQ(chip_.read_register(0x43), 0x03);
  chip_.write_register(0x30, 0x00);
  EXPECT_EQ(chip_.reserved_writes(), 1U);
}

}  // namespace
}  // namespace zerorate::hal::sim

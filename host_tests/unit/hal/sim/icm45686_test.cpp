/// @file
/// The simulated chip against what is known of the real one, register by register.

#include "hal/sim/icm45686.hpp"

#include <gtest/gtest.h>

#include <array>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;

class SimulatedIcm45686Test : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::milliseconds(1)); }
  /// Switches the gyro on and lets the transient pass.
  void power_up(std::uint8_t gyro_config0 = 0x49) {
    chip_.write_register(0x1C, gyro_config0);
    chip_.write_register(0x10, 0x0C);
    clock_.advance(core::Duration::seconds(1));
  }
  void open_fifo(std::uint8_t config0) {
    chip_.write_register(0x16, 0x03);
    chip_.write_register(0x1D, config0);
    chip_.write_register(0x21, 0x05);
  }
  std::int16_t read_word(std::uint8_t low_address) {
    const unsigned low = chip_.read_register(low_address);
    const unsigned high = chip_.read_register(static_cast<std::uint8_t>(low_address + 1U));
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
  }
  std::int16_t count() {
    (void)read_word(0x12);
    return read_word(0x12);
  }
  void wait_for_window() {
    while (chip_.read_register(0x7F) != 0x01) {
    }
  }
  std::uint8_t read_behind(std::uint8_t high, std::uint8_t low) {
    wait_for_window();
    chip_.write_register(0x7C, high);
    chip_.write_register(0x7D, low);
    wait_for_window();
    return chip_.read_register(0x7E);
  }
  void write_behind(std::uint8_t high, std::uint8_t low, std::uint8_t value) {
    wait_for_window();
    chip_.write_register(0x7C, high);
    chip_.write_register(0x7D, low);
    chip_.write_register(0x7E, value);
  }
  void measure_x(float dps) {
    chip_.measure({deg_per_s(dps), {}, {}}, core::Temperature::from_degc(25.0F));
  }

  SimulatedClock clock_;
  SimulatedIcm45686 chip_{clock_};
};

TEST_F(SimulatedIcm45686Test, ReadsAsInvalidUntilItMeasures) {
  EXPECT_EQ(read_word(0x06), -32768);
  measure_x(10.0F);  // powered down
  EXPECT_EQ(read_word(0x06), -32768);
  power_up();
  measure_x(10.0F);
  EXPECT_EQ(read_word(0x06), 1311);
}

TEST_F(SimulatedIcm45686Test, HasNineRanges) {
  float full_scale_dps = 4000.0F;
  for (unsigned code = 0; code < 9; ++code, full_scale_dps /= 2.0F) {
    power_up(static_cast<std::uint8_t>((code << 4U) | 9U));
    measure_x(full_scale_dps / 4.0F);
    EXPECT_EQ(read_word(0x06), 8192) << code;
  }
}

TEST_F(SimulatedIcm45686Test, MeasuresSpecificForceBesideTheRate) {
  chip_.set_specific_force({core::standard_gravity(-1.0F), {}, core::standard_gravity(40.0F)});
  power_up();
  chip_.write_register(0x10, 0x0F);
  clock_.advance(core::Duration::seconds(1));
  // ACCEL_CONFIG0: 32, 16, 8, 4, 2 g
  constexpr std::array<std::int16_t, 5> kRawOf1g{1024, 2048, 4096, 8192, 16384};
  for (std::size_t code = 0; code < kRawOf1g.size(); ++code) {
    chip_.write_register(0x1B, static_cast<std::uint8_t>((code << 4U) | 0x09U));
    measure_x(10.0F);
    EXPECT_EQ(read_word(0x00), -kRawOf1g.at(code));
    EXPECT_EQ(read_word(0x02), 0);
    EXPECT_EQ(read_word(0x04), 32767) << "clipped";
    EXPECT_EQ(read_word(0x06), 1311);
  }
}

TEST_F(SimulatedIcm45686Test, SregCtrlTurnsTheBytesRound) {
  power_up();
  write_behind(0xA2, 0x67, 0x02);
  measure_x(10.0F);  // 051Fh
  EXPECT_EQ(chip_.read_register(0x06), 0x05);
  EXPECT_EQ(chip_.read_register(0x07), 0x1F);
}

TEST_F(SimulatedIcm45686Test, TheWindowTakesTime) {
  EXPECT_EQ(read_behind(0xA4, 0xAC), 0x80);
  EXPECT_EQ(chip_.reserved_writes(), 0U);
  EXPECT_EQ(chip_.read_register(0x7F), 0x00) << "it fetches the next";
  EXPECT_EQ(chip_.read_register(0x7F), 0x01);
  chip_.write_register(0x7C, 0xA4);
  chip_.write_register(0x7D, 0xAC);
  (void)chip_.read_register(0x7E);
  EXPECT_EQ(chip_.reserved_writes(), 1U) << "too early";
}

TEST_F(SimulatedIcm45686Test, FiltersTakeNoValueWhileNothingRuns) {
  write_behind(0xA4, 0xAC, 0x81);
  EXPECT_EQ(read_behind(0xA4, 0xAC), 0x80);
  power_up();
  write_behind(0xA4, 0xAC, 0x81);
  EXPECT_EQ(read_behind(0xA4, 0xAC), 0x81);
}

TEST_F(SimulatedIcm45686Test, DataReadyFallsWhenTheStatusIsRead) {
  power_up();
  chip_.write_register(0x16, 0x04);
  chip_.read_register(0x19);
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x19), 0x04);
  EXPECT_EQ(chip_.read_register(0x19), 0x00);
  chip_.write_register(0x16, 0x00);
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x19), 0x00) << "it shows what is enabled";
}

TEST_F(SimulatedIcm45686Test, FifoPacketsHaveACoarseTemperature) {
  open_fifo(0x47);
  power_up();
  chip_.measure({deg_per_s(10.0F), deg_per_s(-10.0F), {}}, core::Temperature::from_degc(35.0F));
  EXPECT_EQ(read_word(0x12), 0) << "the count is one reading old";
  EXPECT_EQ(read_word(0x12), 1);
  // 10 deg/s is 1311 LSB, 051Fh; 10 degrees are 20 counts.
  constexpr std::array<std::uint8_t, 8> kPacket{0x20, 0x1F, 0x05, 0xE1, 0xFA, 0, 0, 20};
  for (const std::uint8_t byte : kPacket) EXPECT_EQ(chip_.read_register(0x14), byte);
  EXPECT_EQ(count(), 0);
  EXPECT_EQ(chip_.read_register(0x14), 0xFF);
}

TEST_F(SimulatedIcm45686Test, StopOnFullKeepsTheOldest) {
  open_fifo(0x87);
  power_up();
  chip_.read_register(0x19);
  measure_x(10.0F);
  for (int i = 0; i < 254; ++i) measure_x(0.0F);
  EXPECT_EQ(chip_.read_register(0x19) & 0x01U, 0x00U);
  for (int i = 0; i < 10; ++i) measure_x(0.0F);
  EXPECT_EQ(chip_.read_register(0x19) & 0x01U, 0x01U);
  EXPECT_EQ(count(), 256);
  (void)chip_.read_register(0x14);
  EXPECT_EQ(chip_.read_register(0x14), 0x1F);
}

TEST_F(SimulatedIcm45686Test, StreamDropsTheOldest) {
  open_fifo(0x47);
  power_up();
  for (int i = 0; i < 300; ++i) measure_x(i < 44 ? 10.0F : 0.0F);
  EXPECT_EQ(count(), 256);
  (void)chip_.read_register(0x14);
  EXPECT_EQ(chip_.read_register(0x14), 0x00);
}

TEST_F(SimulatedIcm45686Test, AFlushTakesTime) {
  open_fifo(0x87);
  power_up();
  measure_x(1.0F);
  chip_.write_register(0x20, 0xA0);
  EXPECT_EQ(chip_.read_register(0x20), 0xA0);
  measure_x(1.0F);
  clock_.advance(core::Duration::milliseconds(1));
  EXPECT_EQ(chip_.read_register(0x20), 0x20);
  EXPECT_EQ(count(), 0);
}

TEST_F(SimulatedIcm45686Test, CountsWhatIsAgainstTheOrder) {
  chip_.write_register(0x18, 0x01);  // INT1_CONFIG0 is 80h
  EXPECT_EQ(chip_.reserved_writes(), 1U);
  chip_.write_register(0x21, 0x01);  // the FIFO has no mode
  EXPECT_EQ(chip_.reserved_writes(), 2U);
  chip_.write_register(0x1D, 0x87);
  chip_.write_register(0x1D, 0x9F);  // another depth while it is open
  EXPECT_EQ(chip_.reserved_writes(), 3U);
  chip_.write_register(0x20, 0x28);
  EXPECT_EQ(chip_.reserved_writes(), 4U);
  chip_.write_register(0x60, 0x01);
  EXPECT_EQ(chip_.reserved_writes(), 5U) << "reserved";
}

TEST_F(SimulatedIcm45686Test, SoftwareResetTakesAMillisecond) {
  power_up();
  chip_.write_register(0x7F, 0x02);
  EXPECT_FALSE(chip_.is_powered());
  chip_.write_register(0x1C, 0x49);  // refused: still in reset
  clock_.advance(core::Duration::milliseconds(1));
  EXPECT_EQ(chip_.read_register(0x1C), 0x06);
  EXPECT_EQ(chip_.read_register(0x19), 0x80) << "RESET_DONE";
  EXPECT_EQ(chip_.read_register(0x72), 0xE9);
}

}  // namespace
}  // namespace zerorate::hal::sim

/// @file
/// The simulated chip against what is known of the real one, register by register.

#include "hal/sim/icm20948.hpp"

#include <gtest/gtest.h>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;

class SimulatedIcm20948Test : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::seconds(1)); }
  void wake() {
    chip_.write_register(0x06, 0x01);
    clock_.advance(core::Duration::seconds(1));
  }
  void write_bank_2(std::uint8_t address, std::uint8_t value) {
    chip_.write_register(0x7F, 0x20);
    chip_.write_register(address, value);
    chip_.write_register(0x7F, 0x00);
  }
  void measure_x(float dps) {
    chip_.measure({deg_per_s(dps), {}, {}}, core::Temperature::from_degc(31.0F));
  }
  std::int16_t read_word(std::uint8_t high_address) {
    const unsigned high = chip_.read_register(high_address);
    const unsigned low = chip_.read_register(static_cast<std::uint8_t>(high_address + 1U));
    return static_cast<std::int16_t>(static_cast<std::uint16_t>((high << 8U) | low));
  }
  int pop_word() {
    const int high = chip_.read_register(0x72);
    return high * 256 + chip_.read_register(0x72);
  }

  SimulatedClock clock_;
  SimulatedIcm20948 chip_{clock_};
};

TEST_F(SimulatedIcm20948Test, SaysWhoItIsAndSleeps) {
  EXPECT_EQ(chip_.read_register(0x00), 0xEA);
  EXPECT_EQ(chip_.read_register(0x05), 0x40);
  EXPECT_EQ(chip_.read_register(0x06), 0x41);
  EXPECT_FALSE(chip_.is_powered());
  measure_x(10.0F);
  EXPECT_EQ(read_word(0x33), 0);
  EXPECT_EQ(chip_.read_register(0x1A), 0);
}

TEST_F(SimulatedIcm20948Test, HasFourBanksBehindOneRegister) {
  wake();
  write_bank_2(0x00, 8);
  EXPECT_EQ(chip_.read_register(0x00), 0xEA);
  chip_.write_register(0x7F, 0x20);
  EXPECT_EQ(chip_.read_register(0x7F), 0x20);
  EXPECT_EQ(chip_.read_register(0x00), 8);
  EXPECT_EQ(chip_.read_register(0x14), 0x01);
  EXPECT_EQ(chip_.sample_period(), core::Duration::milliseconds(8));
  chip_.write_register(0x7F, 0x10);
  EXPECT_EQ(chip_.read_register(0x00), 0);
  chip_.write_register(0x00, 1);
  EXPECT_EQ(chip_.reserved_writes(), 1U);
  chip_.write_register(0x7F, 0x00);
  chip_.write_register(0x00, 1);
  EXPECT_EQ(chip_.read_register(0x00), 0xEA) << "read-only";
  EXPECT_EQ(chip_.reserved_writes(), 1U);
}

TEST_F(SimulatedIcm20948Test, MeasuresInFourRanges) {
  wake();
  for (unsigned code = 0; code < 4; ++code) {
    write_bank_2(0x01, static_cast<std::uint8_t>(0x01U | (code << 1U)));
    write_bank_2(0x14, static_cast<std::uint8_t>(0x01U | (code << 1U)));
    measure_x(100.0F);
    EXPECT_NEAR(read_word(0x33), 100.0 * 131.072 / (1U << code), 0.5);
    EXPECT_EQ(read_word(0x31), 16384 >> code) << "1 g";
  }
  EXPECT_EQ(read_word(0x39), 3339) << "10 degrees above 21";
}

TEST_F(SimulatedIcm20948Test, DataReadyFallsWhenItIsRead) {
  wake();
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x1A), 0x01);
  EXPECT_EQ(chip_.read_register(0x1A), 0x00);
}

TEST_F(SimulatedIcm20948Test, FifoDropsItsOldestBytes) {
  wake();
  chip_.write_register(0x67, 0x1E);
  chip_.write_register(0x03, 0x40);
  measure_x(1.0F);
  EXPECT_EQ(read_word(0x70), 12);
  for (int i = 0; i < 4; ++i) (void)chip_.read_register(0x72);
  EXPECT_EQ(pop_word(), 16384) << "1 g on z";
  for (int i = 0; i < 60; ++i) measure_x(2.0F);
  EXPECT_EQ(read_word(0x70), 512);
  EXPECT_EQ(chip_.read_register(0x1B), 0x01);
  chip_.write_register(0x68, 0x1F);
  measure_x(1.0F);
  EXPECT_EQ(read_word(0x70), 0) << "held empty";
  chip_.write_register(0x68, 0x00);
  measure_x(1.0F);
  EXPECT_EQ(read_word(0x70), 12);
}

TEST_F(SimulatedIcm20948Test, SnapshotKeepsTheOldest) {
  wake();
  chip_.write_register(0x67, 0x0E);
  chip_.write_register(0x69, 0x01);
  chip_.write_register(0x03, 0x40);
  for (int i = 1; i < 100; ++i) measure_x(static_cast<float>(i));
  EXPECT_EQ(read_word(0x70), 512);
  EXPECT_EQ(pop_word(), 131);
}

TEST_F(SimulatedIcm20948Test, LatchedInterruptWaitsForTheStatus) {
  wake();
  chip_.write_register(0x0F, 0x20);
  chip_.write_register(0x11, 0x01);
  measure_x(0.0F);
  EXPECT_TRUE(chip_.interrupt().level());
  (void)chip_.read_register(0x1A);
  EXPECT_FALSE(chip_.interrupt().level());
}

TEST_F(SimulatedIcm20948Test, OffsetRegistersAreAdded) {
  wake();
  write_bank_2(0x04, 0x64);  // 100 times 1000 deg/s by 2^15
  measure_x(0.0F);
  EXPECT_EQ(read_word(0x33), 400);
}

TEST_F(SimulatedIcm20948Test, ResetBringsEverythingBack) {
  wake();
  chip_.write_register(0x07, 0x38);
  chip_.write_register(0x06, 0x80);
  EXPECT_FALSE(chip_.is_powered());
  chip_.write_register(0x06, 0x01);  // refused: still in reset
  EXPECT_EQ(chip_.read_register(0x06), 0x41);
  clock_.advance(core::Duration::milliseconds(100));
  chip_.write_register(0x06, 0x01);
  EXPECT_EQ(chip_.read_register(0x06), 0x01);
  EXPECT_EQ(chip_.read_register(0x07), 0x00);
}

}  // namespace
}  // namespace zerorate::hal::sim

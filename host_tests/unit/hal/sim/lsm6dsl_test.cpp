/// @file
/// The simulated chip against what is public of its registers: drivers/lsm6dso/README.md.

#include "hal/sim/lsm6dsl.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;

class SimulatedLsm6dslTest : public ::testing::Test {
 protected:
  SimulatedLsm6dslTest() {
    clock_.advance(core::Duration::seconds(1));
    chip_.write_register(0x11, 0x40);  // CTRL2_G: 104 Hz, 250 deg/s
    clock_.advance(core::Duration::seconds(1));
  }
  /// @param fifo_ctrl3 decimation of gyro and accelerometer
  void batch(std::uint8_t fifo_ctrl3, std::uint8_t mode = 6) {
    chip_.write_register(0x08, fifo_ctrl3);
    chip_.write_register(0x0A, static_cast<std::uint8_t>(0x40U | mode));
  }
  /// 100, 200 and 300 counts; 8.75 mdps each.
  void measure(float times = 1.0F) {
    constexpr float kDps = 0.875F;
    chip_.measure(
        {deg_per_s(times * kDps), deg_per_s(times * 2.0F * kDps), deg_per_s(times * 3.0F * kDps)},
        core::Temperature::from_degc(25.0F));
  }
  unsigned level() {
    const unsigned low = chip_.read_register(0x3A);
    return low | ((chip_.read_register(0x3B) & 7U) << 8U);
  }
  unsigned flags() { return chip_.read_register(0x3B) & 0xF0U; }
  /// One burst, from the data register on.
  std::vector<int> pop(std::size_t words) {
    std::vector<int> values;
    std::uint8_t address = 0x3E;
    for (std::size_t i = 0; i < words; ++i) {
      std::array<unsigned, 2> bytes{};
      for (unsigned& byte : bytes) {
        byte = chip_.read_register(address);
        address = chip_.next_address(address);
      }
      values.push_back(static_cast<std::int16_t>(bytes[0] | (bytes[1] << 8U)));
    }
    return values;
  }

  SimulatedClock clock_;
  SimulatedLsm6dsl chip_{clock_};
};

TEST_F(SimulatedLsm6dslTest, HasItsOwnRegisters) {
  EXPECT_EQ(chip_.read_register(0x0F), 0x6A);
  chip_.write_register(0x06, 0x12);  // FIFO_CTRL1
  EXPECT_EQ(chip_.read_register(0x06), 0x12);
  EXPECT_EQ(chip_.reserved_writes(), 0U);
  for (const auto address : std::to_array<std::uint8_t>({0x02, 0x0C, 0x57, 0x63, 0x70})) {
    chip_.write_register(address, 0x00);
  }
  EXPECT_EQ(chip_.reserved_writes(), 5U);
}

TEST_F(SimulatedLsm6dslTest, KeepsNothingWhereNoFifoIsOn) {
  measure();
  EXPECT_EQ(level(), 0U);
  batch(0x08, 0);  // bypass
  measure();
  chip_.write_register(0x0A, 0x06);  // no rate
  measure();
  EXPECT_EQ(level(), 0U);
  EXPECT_EQ(flags(), 0x10U) << "FIFO_EMPTY";
  EXPECT_EQ(pop(1), std::vector<int>{0});
  EXPECT_EQ(chip_.read_register(0x78), 0x00) << "there are no tags";
}

TEST_F(SimulatedLsm6dslTest, KeepsTheGyrosWordsInOrder) {
  batch(0x08);
  measure(1.0F);
  measure(-1.0F);
  EXPECT_EQ(level(), 6U);
  EXPECT_EQ(flags(), 0x00U);
  EXPECT_EQ(pop(1), std::vector<int>{100});
  EXPECT_EQ(chip_.read_register(0x3C), 1U) << "the second of the pattern comes next";
  EXPECT_EQ(pop(5), (std::vector<int>{200, 300, -100, -200, -300}));
  EXPECT_EQ(flags(), 0x10U);
}

TEST_F(SimulatedLsm6dslTest, PutsTheAccelerometerBehindTheGyro) {
  chip_.write_register(0x10, 0x48);  // CTRL1_XL: 104 Hz, 4 g
  chip_.set_specific_force({core::standard_gravity(0.122F), {}, core::standard_gravity(1.22F)});
  clock_.advance(core::Duration::seconds(1));
  batch(0x09);
  measure();
  EXPECT_EQ(pop(6), (std::vector<int>{100, 200, 300, 1000, 0, 10000}));
}

TEST_F(SimulatedLsm6dslTest, StampsASetInItsOddOrder) {
  chip_.write_register(0x19, 0x20);  // CTRL10_C: TIMER_EN
  chip_.write_register(0x5C, 0x10);  // TIMER_HR: 25 us
  chip_.write_register(0x07, 0x80);  // TIMER_PEDO_FIFO_EN
  chip_.write_register(0x09, 0x08);  // DEC_DS4_FIFO
  batch(0x08);
  clock_.advance(core::Duration::microseconds(std::int64_t{0x012345} * 25));
  measure();
  EXPECT_EQ(pop(6), (std::vector<int>{100, 200, 300, 0x0123, 0x4500, 0}));
  chip_.write_register(0x42, 0xAA);
  clock_.advance(core::Duration::microseconds(7 * 25));
  measure();
  EXPECT_EQ(pop(6).at(4), 0x0700);
  chip_.write_register(0x5C, 0x00);  // 6.4 ms
  clock_.advance(core::Duration::microseconds(3 * 6400 - 7 * 25));
  measure();
  EXPECT_EQ(pop(6).at(4), 0x0300);
}

TEST_F(SimulatedLsm6dslTest, RaisesInt1AtTheWatermark) {
  chip_.write_register(0x0D, 0x08);  // INT1_FTH
  chip_.write_register(0x06, 0x06);
  batch(0x08);
  measure();
  EXPECT_FALSE(chip_.interrupt().level());
  measure();
  EXPECT_TRUE(chip_.interrupt().level());
  EXPECT_EQ(flags(), 0x80U);
  pop(1);
  EXPECT_FALSE(chip_.interrupt().level());
  measure();
  EXPECT_TRUE(chip_.interrupt().level());
  chip_.write_register(0x0A, 0x00);  // bypass empties it
  EXPECT_FALSE(chip_.interrupt().level());
  EXPECT_EQ(level(), 0U);
}

TEST_F(SimulatedLsm6dslTest, LosesTheOldestOrTheNewestWhenFull) {
  constexpr unsigned kSets = 682;
  for (const std::uint8_t mode : {std::uint8_t{6}, std::uint8_t{1}}) {
    chip_.write_register(0x0A, 0x00);
    batch(0x08, mode);
    for (unsigned i = 0; i < kSets; ++i) measure(i == 0 ? 2.0F : 1.0F);
    EXPECT_EQ(level(), 3 * kSets);
    EXPECT_EQ(flags() & 0x60U, 0x20U) << "full";
    measure(3.0F);
    EXPECT_EQ(level(), 3 * kSets);
    EXPECT_EQ(flags() & 0x60U, 0x60U) << "overrun";
    EXPECT_EQ(pop(3).front(), mode == 6 ? 100 : 200);
    EXPECT_EQ(flags() & 0x60U, 0x00U);
  }
}

TEST_F(SimulatedLsm6dslTest, ForgetsItsFifoInAReset) {
  batch(0x08);
  measure();
  chip_.write_register(0x12, 0x01);  // SW_RESET
  clock_.advance(core::Duration::milliseconds(1));
  EXPECT_EQ(level(), 0U);
  EXPECT_EQ(chip_.read_register(0x0A), 0x00);
  chip_.write_register(0x11, 0x40);
  batch(0x08);
  measure();
  EXPECT_EQ(level(), 3U);
  chip_.cycle_power();
  EXPECT_EQ(level(), 0U);
}

}  // namespace
}  // namespace zerorate::hal::sim

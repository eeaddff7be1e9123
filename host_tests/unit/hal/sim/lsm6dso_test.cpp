/// @file
/// The simulated chip against the datasheet (ST DS12140), register by register.

#include "hal/sim/lsm6dso.hpp"

#include <gtest/gtest.h>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;
using core::standard_gravity;
constexpr core::Temperature kRoomTemperature = core::Temperature::from_degc(25.0F);

class SimulatedLsm6dsoTest : public ::testing::Test {
 protected:
  /// Switches the gyro on and lets the transient pass.
  void power_up(std::uint8_t ctrl2_g = 0x40) {
    chip_.write_register(0x11, ctrl2_g);
    clock_.advance(core::Duration::seconds(1));
  }
  std::int16_t read_word(std::uint8_t low_address) {
    const unsigned low = chip_.read_register(low_address);
    const unsigned high = chip_.read_register(static_cast<std::uint8_t>(low_address + 1U));
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
  }
  unsigned fifo_level() {
    const unsigned low = chip_.read_register(0x3A);
    return low | ((chip_.read_register(0x3B) & 3U) << 8U);
  }
  std::array<std::uint8_t, 7> pop_word() {
    std::array<std::uint8_t, 7> word{};
    std::uint8_t address = 0x78;
    for (std::uint8_t& byte : word) byte = chip_.read_register(address++);
    return word;
  }
  void measure_x(float dps) { chip_.measure({deg_per_s(dps), {}, {}}, kRoomTemperature); }

  SimulatedClock clock_;
  SimulatedLsm6dso chip_{clock_, -3};
};

TEST_F(SimulatedLsm6dsoTest, HasTheResetValuesOfTheDatasheet) {
  for (std::uint8_t address = 0; address < 0x78; ++address) {
    std::uint8_t expected = 0;
    if (address == 0x02) expected = 0x3F;  // PIN_CTRL
    if (address == 0x0F) expected = 0x6C;  // WHO_AM_I
    if (address == 0x12) expected = 0x04;  // CTRL3_C
    if (address == 0x18) expected = 0xE0;  // CTRL9_XL
    if (address == 0x63) expected = 0xFD;  // INTERNAL_FREQ_FINE: this chip's trim, -3
    EXPECT_EQ(chip_.read_register(address), expected) << int{address};
  }
}

TEST_F(SimulatedLsm6dsoTest, HasRelativesWith4000dps) {
  SimulatedIsm330dhcx industrial{clock_};
  SimulatedAsm330lhh automotive{clock_};
  EXPECT_EQ(industrial.read_register(0x0F), 0x6B);
  EXPECT_EQ(automotive.read_register(0x0F), 0x6B);
  for (SimulatedLsm6dso* chip : {&chip_, &static_cast<SimulatedLsm6dso&>(industrial),
                                 &static_cast<SimulatedLsm6dso&>(automotive)}) {
    chip->write_register(0x11, 0x41);  // CTRL2_G: 104 Hz, FS_4000
    clock_.advance(core::Duration::seconds(1));
    chip->measure({deg_per_s(14.0F), {}, {}}, kRoomTemperature);
    const unsigned low = chip->read_register(0x22);
    const unsigned high = chip->read_register(0x23);
    EXPECT_EQ(low | (high << 8U), chip == &chip_ ? 1600U : 100U);
  }
}

TEST_F(SimulatedLsm6dsoTest, IgnoresReadOnlyAndCountsReserved) {
  chip_.write_register(0x0F, 0x00);
  chip_.write_register(0x22, 0x55);
  EXPECT_EQ(chip_.read_register(0x0F), 0x6C);
  EXPECT_EQ(chip_.read_register(0x22), 0x00);
  EXPECT_EQ(chip_.reserved_writes(), 0U);
  chip_.write_register(0x03, 0xFF);
  EXPECT_EQ(chip_.reserved_writes(), 1U);
}

TEST_F(SimulatedLsm6dsoTest, SoftwareResetRestoresTheRegisters) {
  power_up();
  chip_.write_register(0x12, 0x05);
  EXPECT_EQ(chip_.read_register(0x12), 0x05);
  EXPECT_FALSE(chip_.is_powered());
  chip_.write_register(0x11, 0x40);  // refused: still in reset
  clock_.advance(core::Duration::microseconds(50));
  EXPECT_EQ(chip_.read_register(0x12), 0x04);
  EXPECT_EQ(chip_.read_register(0x11), 0x00);
}

// The kernel's driver writes BOOT, and carries on whatever it reads back.
TEST_F(SimulatedLsm6dsoTest, ClearsBootWhenItIsDone) {
  chip_.write_register(0x12, 0x84);
  EXPECT_EQ(chip_.read_register(0x12), 0x84);
  clock_.advance(core::Duration::milliseconds(10));
  EXPECT_EQ(chip_.read_register(0x12), 0x04);
}

TEST_F(SimulatedLsm6dsoTest, MeasuresNothingWhilePoweredDown) {
  measure_x(10.0F);
  EXPECT_EQ(chip_.read_register(0x1E), 0x00);
  EXPECT_EQ(read_word(0x22), 0);
}

TEST_F(SimulatedLsm6dsoTest, RoundsToTheNearestLsbAndSaturates) {
  power_up();
  const auto raw_x = [this](float dps) {
    measure_x(dps);
    return read_word(0x22);
  };
  EXPECT_EQ(raw_x(0.0F), 0);
  EXPECT_EQ(raw_x(8.75e-3F * 0.49F), 0);
  EXPECT_EQ(raw_x(8.75e-3F * 0.51F), 1);
  EXPECT_EQ(raw_x(-8.75e-3F * 1.51F), -2);
  EXPECT_EQ(raw_x(250.0F), 28571);
  EXPECT_EQ(raw_x(1e6F), 32767);
  EXPECT_EQ(raw_x(-1e6F), -32768);
}

TEST_F(SimulatedLsm6dsoTest, HasFiveRanges) {
  struct Range {
    std::uint8_t ctrl2_g;
    std::int16_t raw_of_100_dps;
  };
  for (const Range& range : {Range{0x42, 22857}, Range{0x40, 11429}, Range{0x44, 5714},
                             Range{0x48, 2857}, Range{0x4C, 1429}}) {
    power_up(range.ctrl2_g);
    measure_x(100.0F);
    EXPECT_EQ(read_word(0x22), range.raw_of_100_dps);
  }
}

TEST_F(SimulatedLsm6dsoTest, Gives256thsOfADegreeAbout25) {
  power_up();
  chip_.measure({}, core::Temperature::from_degc(26.0F));
  EXPECT_EQ(read_word(0x20), 256);
  chip_.measure({}, core::Temperature::from_degc(-40.0F));
  EXPECT_EQ(read_word(0x20), -65 * 256);
}

TEST_F(SimulatedLsm6dsoTest, DataReadyFallsWhenAHighByteIsRead) {
  power_up();
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x1E), 0x06);
  chip_.read_register(0x22);
  EXPECT_EQ(chip_.read_register(0x1E), 0x06);
  chip_.read_register(0x23);
  EXPECT_EQ(chip_.read_register(0x1E), 0x04);
  chip_.read_register(0x21);
  EXPECT_EQ(chip_.read_register(0x1E), 0x00);
}

TEST_F(SimulatedLsm6dsoTest, BlockDataUpdateHoldsAPairOfBytes) {
  power_up();
  constexpr float kLow = 8.75e-3F * 0x00FF;
  constexpr float kHigh = 8.75e-3F * 0x0100;
  for (const bool is_blocked : {false, true}) {
    chip_.write_register(0x12, is_blocked ? 0x44 : 0x04);
    measure_x(kLow);
    const unsigned low = chip_.read_register(0x22);
    measure_x(kHigh);
    const unsigned high = chip_.read_register(0x23);
    EXPECT_EQ(low | (high << 8U), is_blocked ? 0x00FFU : 0x01FFU);
    EXPECT_EQ(read_word(0x22), 0x0100) << "the new value is there afterwards";
  }
}

TEST_F(SimulatedLsm6dsoTest, TheFirst70MillisecondsAreOff) {
  chip_.write_register(0x11, 0x40);
  clock_.advance(core::Duration::milliseconds(35));
  measure_x(0.0F);
  EXPECT_NEAR(read_word(0x22), 10.0 / 8.75e-3, 1.0);  // half of 20 deg/s
  clock_.advance(core::Duration::milliseconds(35));
  measure_x(0.0F);
  EXPECT_EQ(read_word(0x22), 0);
}

TEST_F(SimulatedLsm6dsoTest, FifoWordsHaveSensorSlotAndParity) {
  chip_.write_register(0x09, 0x40);
  chip_.write_register(0x0A, 0x06);
  power_up();
  for (int i = 0; i < 5; ++i) measure_x(8.75e-3F * 0x0102);
  EXPECT_EQ(fifo_level(), 5U);
  // Gyro is sensor 1; two bits of time slot; parity makes the number of ones even.
  constexpr std::array<std::uint8_t, 5> kTags{0b00001'00'1, 0b00001'01'0, 0b00001'10'0,
                                              0b00001'11'1, 0b00001'00'1};
  for (const std::uint8_t tag : kTags) {
    EXPECT_EQ(pop_word(), (std::array<std::uint8_t, 7>{tag, 0x02, 0x01, 0, 0, 0, 0}));
  }
  EXPECT_EQ(fifo_level(), 0U);
}

TEST_F(SimulatedLsm6dsoTest, MeasuresSpecificForceBesideTheRate) {
  chip_.set_specific_force({standard_gravity(-0.5F), standard_gravity(1.0F), {}});
  power_up();
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x1E), 0x06) << "it is off";
  EXPECT_EQ(read_word(0x28), 0);
  struct Range {
    std::uint8_t ctrl1_xl;
    std::int16_t raw_of_1_g;
  };
  // Sensitivities of table 2: 0.061, 0.122, 0.244 and 0.488 mg, whose codes are 0, 2, 3, 1.
  for (const Range& range :
       {Range{0x40, 16393}, Range{0x48, 8197}, Range{0x4C, 4098}, Range{0x44, 2049}}) {
    chip_.write_register(0x10, range.ctrl1_xl);
    clock_.advance(core::Duration::seconds(1));
    measure_x(1.0F);
    EXPECT_EQ(chip_.read_register(0x1E) & 0x01, 0x01);
    EXPECT_NEAR(read_word(0x28), -0.5 * range.raw_of_1_g, 1.0);
    EXPECT_EQ(read_word(0x2A), range.raw_of_1_g);
    EXPECT_EQ(read_word(0x2C), 0);
    EXPECT_EQ(chip_.read_register(0x1E) & 0x01, 0x00) << "cleared by a high byte";
  }
}

TEST_F(SimulatedLsm6dsoTest, ClipsSpecificForceAtTheEndOfItsRange) {
  chip_.set_specific_force({standard_gravity(9.0F), standard_gravity(-9.0F), {}});
  chip_.write_register(0x10, 0x48);
  power_up();
  measure_x(0.0F);
  EXPECT_EQ(read_word(0x28), 32767);
  EXPECT_EQ(read_word(0x2A), -32768);
}

TEST_F(SimulatedLsm6dsoTest, BatchesBothSensorsInOneSlot) {
  chip_.set_specific_force({core::Acceleration{}, core::Acceleration{}, standard_gravity(1.0F)});
  chip_.write_register(0x09, 0x44);
  chip_.write_register(0x0A, 0x06);
  chip_.write_register(0x10, 0x48);
  power_up();
  measure_x(8.75e-3F);
  chip_.lose_accelerations(1);
  measure_x(8.75e-3F);
  measure_x(8.75e-3F);
  ASSERT_EQ(fifo_level(), 5U);
  EXPECT_EQ(pop_word(), (std::array<std::uint8_t, 7>{0b00001'00'1, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(pop_word(), (std::array<std::uint8_t, 7>{0b00010'00'1, 0, 0, 0, 0, 0x05, 0x20}));
  EXPECT_EQ(pop_word()[0], 0b00001'01'0);
  EXPECT_EQ(pop_word()[0], 0b00001'10'0);
  EXPECT_EQ(pop_word()[0], 0b00010'10'0);
}

// The kernel's driver stamps its samples by these words, which come before those of their slot.
TEST_F(SimulatedLsm6dsoTest, BatchesTimeStampsOf25us) {
  chip_.write_register(0x09, 0x40);
  chip_.write_register(0x0A, 0x46);  // DEC_TS_BATCH: each slot
  power_up();
  measure_x(0.0F);
  EXPECT_EQ(fifo_level(), 1U) << "the timer is off";
  pop_word();
  chip_.write_register(0x19, 0x20);  // TIMESTAMP_EN
  clock_.advance(core::Duration::seconds(5));
  chip_.write_register(0x42, 0xAA);
  EXPECT_EQ(read_word(0x40), 0);
  clock_.advance(core::Duration::seconds(10));
  measure_x(0.0F);
  ASSERT_EQ(fifo_level(), 2U);
  constexpr unsigned kTicks = 398'200;  // 10 s / 25 us, 0.45 % slow
  EXPECT_EQ(read_word(0x40), static_cast<std::int16_t>(kTicks & 0xFFFFU));
  EXPECT_EQ(read_word(0x42), kTicks >> 16U);
  EXPECT_EQ(pop_word(),
            (std::array<std::uint8_t, 7>{0b00100'01'0, kTicks & 0xFFU, kTicks >> 8U & 0xFFU,
                                         kTicks >> 16U, 0, 0, 0}));
  EXPECT_EQ(pop_word()[0], 0b00001'01'0) << "the gyro's word of the same slot";
}

TEST_F(SimulatedLsm6dsoTest, MarksSettlingSamplesIfAsked) {
  for (const bool is_masked : {false, true}) {
    chip_.write_register(0x12, 0x05);
    clock_.advance(core::Duration::milliseconds(1));
    chip_.write_register(0x13, is_masked ? 0x08 : 0x00);  // DRDY_MASK
    chip_.write_register(0x09, 0x40);
    chip_.write_register(0x0A, 0x06);
    chip_.write_register(0x11, 0x40);
    clock_.advance(core::Duration::milliseconds(60));
    measure_x(0.0F);
    EXPECT_EQ(chip_.read_register(0x1E), is_masked ? 0x00 : 0x06);
    const auto settling = pop_word();
    EXPECT_EQ(settling[1] == 0xFF && settling[2] == 0x7F, is_masked);
    clock_.advance(core::Duration::milliseconds(10));
    measure_x(0.0F);
    EXPECT_EQ(chip_.read_register(0x1E), 0x06);
    EXPECT_EQ(pop_word()[2], 0);
  }
}

// The kernel's driver configures the sensor hub at the addresses of CTRL5_C and those that follow.
TEST_F(SimulatedLsm6dsoTest, KeepsTheBanksOfHubAndFunctionsApart) {
  chip_.write_register(0x15, 0x10);
  chip_.write_register(0x01, 0x40);
  EXPECT_EQ(chip_.read_register(0x15), 0x00);
  chip_.write_register(0x15, 0x3D);
  chip_.write_register(0x01, 0x80);
  EXPECT_EQ(chip_.read_register(0x15), 0x00);
  chip_.write_register(0x01, 0x40);
  EXPECT_EQ(chip_.read_register(0x15), 0x3D);
  chip_.write_register(0x01, 0x00);
  EXPECT_EQ(chip_.read_register(0x15), 0x10);
  EXPECT_EQ(chip_.read_register(0x0F), 0x6C);
}

TEST_F(SimulatedLsm6dsoTest, ContinuousFifoDropsTheOldest) {
  chip_.write_register(0x09, 0x40);
  chip_.write_register(0x0A, 0x06);
  power_up();
  for (int i = 0; i < 512; ++i) measure_x(8.75e-3F * static_cast<float>(i));
  EXPECT_EQ(chip_.read_register(0x3B), 0x22);  // full, not overrun
  measure_x(8.75e-3F * 512);
  EXPECT_EQ(chip_.read_register(0x3B), 0x6A);  // overrun, full, latched
  EXPECT_EQ(chip_.read_register(0x3B), 0x62);  // the latch fell by reading
  EXPECT_EQ(pop_word()[1], 1) << "the word of 0 was overwritten";
  EXPECT_EQ(chip_.read_register(0x3B), 0x21);
}

TEST_F(SimulatedLsm6dsoTest, FifoModeStopsWhenFull) {
  chip_.write_register(0x09, 0x40);
  chip_.write_register(0x0A, 0x01);
  chip_.write_register(0x07, 4);
  chip_.write_register(0x08, 0x80);  // STOP_ON_WTM
  power_up();
  for (int i = 1; i <= 6; ++i) measure_x(8.75e-3F * static_cast<float>(i));
  EXPECT_EQ(fifo_level(), 4U);
  EXPECT_EQ(pop_word()[1], 1);
  chip_.write_register(0x0A, 0x00);
  EXPECT_EQ(fifo_level(), 0U) << "bypass empties";
}

TEST_F(SimulatedLsm6dsoTest, BurstsFollowTheIncrement) {
  EXPECT_EQ(chip_.next_address(0x22), 0x23);
  EXPECT_EQ(chip_.next_address(0x7E), 0x78);
  chip_.write_register(0x12, 0x00);
  EXPECT_EQ(chip_.next_address(0x22), 0x22);
}

TEST_F(SimulatedLsm6dsoTest, PeriodFollowsRateAndTrim) {
  EXPECT_EQ(chip_.sample_period(), core::Duration{});
  power_up(0x40);
  const double expected_ns = 1e9 * 64.0 / (6667.0 * (1.0 - 3 * 0.0015));
  EXPECT_NEAR(static_cast<double>(chip_.sample_period().ns()), expected_ns, 1.0);
}

}  // namespace
}  // namespace zerorate::hal::sim

/// @file
/// The simulated chip against what is known of the real one, register by register.

#include "hal/sim/lsm6dsv16x.hpp"

#include <gtest/gtest.h>

#include <array>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;

class SimulatedLsm6dsv16xTest : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::seconds(1)); }
  /// Switches the gyro on and lets the transient pass.
  void power_up(std::uint8_t range = 0x01, std::uint8_t rate = 0x06) {
    chip_.write_register(0x15, range);
    chip_.write_register(0x11, rate);
    clock_.advance(core::Duration::seconds(1));
  }
  void enable_fifo() {
    chip_.write_register(0x09, 0x60);
    chip_.write_register(0x0A, 0x06);
  }
  void measure_x(float dps) {
    chip_.measure({deg_per_s(dps), {}, {}}, core::Temperature::from_degc(25.0F));
  }
  std::int16_t read_word(std::uint8_t low_address) {
    const unsigned low = chip_.read_register(low_address);
    const unsigned high = chip_.read_register(static_cast<std::uint8_t>(low_address + 1U));
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
  }
  std::array<std::uint8_t, 7> pop_word() {
    std::array<std::uint8_t, 7> word{};
    std::uint8_t address = 0x78;
    for (std::uint8_t& byte : word) byte = chip_.read_register(address++);
    return word;
  }

  SimulatedClock clock_;
  SimulatedLsm6dsv16x chip_{clock_, -3};
};

TEST_F(SimulatedLsm6dsv16xTest, SaysWhoItIsAndHowItsOscillatorIsOff) {
  EXPECT_EQ(chip_.read_register(0x0F), 0x70);
  EXPECT_EQ(chip_.read_register(0x12), 0x44);
  EXPECT_EQ(chip_.read_register(0x4F), 0xFD);
}

TEST_F(SimulatedLsm6dsv16xTest, HasItsRangeInCtrl6) {
  constexpr std::array<std::uint8_t, 6> kCodes{0x0, 0x1, 0x2, 0x3, 0x4, 0xC};
  double lsb_dps = 0.004375;
  for (const std::uint8_t code : kCodes) {
    power_up(code);
    measure_x(static_cast<float>(1000.0 * lsb_dps));
    EXPECT_EQ(read_word(0x22), 1000) << int{code};
    lsb_dps *= 2.0;
  }
}

TEST_F(SimulatedLsm6dsv16xTest, HasItsRateAndItsModeInCtrl2) {
  power_up(0x01, 0x0C);
  EXPECT_NEAR(static_cast<double>(chip_.sample_period().ns()), 1e9 / (7680.0 * 0.9961), 1.0);
  power_up(0x01, 0x02);
  EXPECT_NEAR(static_cast<double>(chip_.sample_period().ns()), 1e9 / (7.5 * 0.9961), 1.0);
  chip_.write_register(0x11, 0x46);  // sleep
  EXPECT_FALSE(chip_.is_powered());
  chip_.write_register(0x11, 0x00);
  EXPECT_FALSE(chip_.is_powered());
}

TEST_F(SimulatedLsm6dsv16xTest, FifoWordsHaveATagWithoutParity) {
  enable_fifo();
  power_up();
  measure_x(8.75F);
  measure_x(8.75F);
  EXPECT_EQ(chip_.read_register(0x1B), 2);
  EXPECT_EQ(pop_word(), (std::array<std::uint8_t, 7>{0x08, 0xE8, 0x03, 0, 0, 0, 0}));
  EXPECT_EQ(pop_word()[0], 0x0A);
  EXPECT_EQ(chip_.read_register(0x1B), 0);
}

TEST_F(SimulatedLsm6dsv16xTest, MeasuresSpecificForce) {
  chip_.set_specific_force({core::Acceleration{}, core::standard_gravity(-1.0F), {}});
  constexpr std::array<std::int16_t, 4> kRawOf1g{16393, 8197, 4098, 2049};
  for (std::size_t code = 0; code < kRawOf1g.size(); ++code) {
    chip_.write_register(0x17, static_cast<std::uint8_t>(code));
    chip_.write_register(0x10, 0x06);
    power_up();
    measure_x(0.0F);
    EXPECT_EQ(chip_.read_register(0x1E), 0x07);
    EXPECT_EQ(read_word(0x2A), -kRawOf1g.at(code));
    EXPECT_EQ(chip_.read_register(0x1E), 0x06);
  }
}

TEST_F(SimulatedLsm6dsv16xTest, BatchesBothSensorsInOneSlot) {
  chip_.write_register(0x09, 0x66);
  chip_.write_register(0x0A, 0x06);
  chip_.write_register(0x10, 0x06);
  chip_.write_register(0x17, 0x01);
  power_up();
  measure_x(0.0F);
  measure_x(0.0F);
  EXPECT_EQ(chip_.read_register(0x1B), 4);
  EXPECT_EQ(pop_word()[0], 0x08);
  EXPECT_EQ(pop_word(), (std::array<std::uint8_t, 7>{0x10, 0, 0, 0, 0, 0x05, 0x20}));
  EXPECT_EQ(pop_word()[0], 0x0A);
  EXPECT_EQ(pop_word()[0], 0x12);
}

TEST_F(SimulatedLsm6dsv16xTest, FifoHolds256WordsAndLatchesAnOverrun) {
  enable_fifo();
  power_up();
  for (int i = 0; i < 256; ++i) measure_x(0.0F);
  EXPECT_EQ(chip_.read_register(0x1B), 0x00);
  EXPECT_EQ(chip_.read_register(0x1C), 0x61);
  measure_x(8.75F);
  EXPECT_EQ(chip_.read_register(0x1C), 0x69);
  EXPECT_EQ(chip_.read_register(0x1C), 0x61) << "cleared by reading";
  for (int i = 0; i < 255; ++i) pop_word();
  EXPECT_EQ(pop_word()[1], 0xE8) << "the newest is kept";
}

TEST_F(SimulatedLsm6dsv16xTest, RaisesInt1AtTheWatermark) {
  enable_fifo();
  chip_.write_register(0x07, 2);
  chip_.write_register(0x0D, 0x08);
  power_up();
  measure_x(0.0F);
  EXPECT_FALSE(chip_.interrupt().level());
  measure_x(0.0F);
  EXPECT_TRUE(chip_.interrupt().level());
}

TEST_F(SimulatedLsm6dsv16xTest, SoftwareResetTakes50Microseconds) {
  power_up();
  chip_.write_register(0x12, 0x45);
  EXPECT_EQ(chip_.read_register(0x12), 0x45);
  EXPECT_FALSE(chip_.is_powered());
  clock_.advance(core::Duration::microseconds(50));
  EXPECT_EQ(chip_.read_register(0x12), 0x44);
  EXPECT_EQ(chip_.read_register(0x15), 0x00);
}

TEST_F(SimulatedLsm6dsv16xTest, CountsWritesToReservedAddresses) {
  chip_.write_register(0x0F, 0x00);
  EXPECT_EQ(chip_.reserved_writes(), 0U);
  chip_.write_register(0x05, 0x00);
  EXPECT_EQ(chip_.reserved_writes(), 1U);
}

}  // namespace
}  // namespace zerorate::hal::sim

/// @file
/// The simulated chip against what is known of the real one, register by register.

#include "hal/sim/icm42688.hpp"

#include <gtest/gtest.h>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;
constexpr core::Temperature kRoom = core::Temperature::from_degc(25.0F);

class SimulatedIcm42688Test : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::milliseconds(1)); }
  /// Switches the gyro on and lets the transient pass.
  void power_up(std::uint8_t gyro_config0 = 0x68) {
    chip_.write_register(0x4F, gyro_config0);
    chip_.write_register(0x4E, 0x0C);
    clock_.advance(core::Duration::seconds(1));
  }
  void enable_fifo() {
    chip_.write_register(0x5F, 0x06);
    chip_.write_register(0x16, 0x40);
  }
  std::int16_t read_word(std::uint8_t high_address) {
    const unsigned high = chip_.read_register(high_address);
    const unsigned low = chip_.read_register(static_cast<std::uint8_t>(high_address + 1U));
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(low | (high << 8U)));
  }
  std::array<std::uint8_t, 8> pop_packet() {
    std::array<std::uint8_t, 8> packet{};
    for (std::uint8_t& byte : packet) byte = chip_.read_register(0x30);
    return packet;
  }
  void measure_x(float dps) { chip_.measure({deg_per_s(dps), {}, {}}, kRoom); }

  SimulatedClock clock_;
  SimulatedIcm42688 chip_{clock_};
};

TEST_F(SimulatedIcm42688Test, ReadsAsInvalidUntilItMeasures) {
  EXPECT_EQ(read_word(0x25), -32768);
  measure_x(10.0F);  // powered down
  EXPECT_EQ(read_word(0x25), -32768);
  power_up();
  measure_x(10.0F);
  EXPECT_EQ(read_word(0x25), 1311);
}

TEST_F(SimulatedIcm42688Test, MeasuresSpecificForceBesideTheRate) {
  chip_.set_specific_force({core::standard_gravity(-1.0F), {}, core::standard_gravity(30.0F)});
  power_up();
  measure_x(10.0F);
  EXPECT_EQ(read_word(0x1F), -32768) << "it is off";
  chip_.write_register(0x4E, 0x0F);
  clock_.advance(core::Duration::seconds(1));
  // ACCEL_CONFIG0: 16, 8, 4, 2 g
  constexpr std::array<std::int16_t, 4> kRawOf1g{2048, 4096, 8192, 16384};
  for (std::size_t code = 0; code < kRawOf1g.size(); ++code) {
    chip_.write_register(0x50, static_cast<std::uint8_t>((code << 5U) | 0x08U));
    measure_x(10.0F);
    EXPECT_EQ(read_word(0x1F), -kRawOf1g.at(code));
    EXPECT_EQ(read_word(0x21), 0);
    EXPECT_EQ(read_word(0x23), 32767) << "clipped";
    EXPECT_EQ(read_word(0x25), 1311);
  }
  chip_.lose_accelerations(1);
  measure_x(10.0F);
  EXPECT_EQ(read_word(0x1F), -32768);
}

TEST_F(SimulatedIcm42688Test, PacketsOfBothSensorsHave16Bytes) {
  chip_.set_specific_force({core::Acceleration{}, {}, core::standard_gravity(1.0F)});
  enable_fifo();
  chip_.write_register(0x5F, 0x07);
  chip_.write_register(0x50, 0x48);
  power_up();
  chip_.write_register(0x4E, 0x0F);
  clock_.advance(core::Duration::seconds(1));
  measure_x(250.0F / 32768.0F * 0x0102);
  EXPECT_EQ(read_word(0x2E), 16);
  constexpr std::array<std::uint8_t, 16> kPacket{0x60, 0, 0, 0, 0, 0x20, 0, 0x01,
                                                 0x02, 0, 0, 0, 0, 0,    0, 0};
  for (const std::uint8_t byte : kPacket) EXPECT_EQ(chip_.read_register(0x30), byte);
  for (int i = 0; i < 130; ++i) measure_x(0.0F);
  EXPECT_EQ(read_word(0x2E), 2048);
  EXPECT_EQ(chip_.read_register(0x2D) & 0x02, 0x02) << "full";
}

TEST_F(SimulatedIcm42688Test, ItsOlderSisterHasAnotherIdentity) {
  SimulatedIcm42605 sister{clock_};
  EXPECT_EQ(chip_.read_register(0x75), 0x47);
  EXPECT_EQ(sister.read_register(0x75), 0x42);
}

TEST_F(SimulatedIcm42688Test, ClipsAtTheEndsOfTheValidRange) {
  power_up();
  measure_x(1000.0F);
  EXPECT_EQ(read_word(0x25), 32767);
  measure_x(-1000.0F);
  EXPECT_EQ(read_word(0x25), -32766);
}

TEST_F(SimulatedIcm42688Test, HasEightRanges) {
  float full_scale_dps = 2000.0F;
  for (unsigned code = 0; code < 8; ++code, full_scale_dps /= 2.0F) {
    power_up(static_cast<std::uint8_t>((code << 5U) | 8U));
    measure_x(full_scale_dps / 4.0F);
    EXPECT_EQ(read_word(0x25), 8192) << code;
  }
}

TEST_F(SimulatedIcm42688Test, DataReadyFallsWhenTheStatusIsRead) {
  power_up();
  chip_.read_register(0x2D);
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x2D), 0x08);
  EXPECT_EQ(chip_.read_register(0x2D), 0x00);
}

TEST_F(SimulatedIcm42688Test, FifoPacketsHaveACoarseTemperature) {
  enable_fifo();
  power_up();
  chip_.measure({deg_per_s(10.0F), deg_per_s(-10.0F), {}}, core::Temperature::from_degc(35.0F));
  EXPECT_EQ(read_word(0x2E), 8);
  // 10 deg/s is 1311 LSB, 051Fh; 10 degrees are 20.7 counts.
  EXPECT_EQ(pop_packet(), (std::array<std::uint8_t, 8>{0x20, 0x05, 0x1F, 0xFA, 0xE1, 0, 0, 21}));
  EXPECT_EQ(read_word(0x2E), 0);
  EXPECT_EQ(chip_.read_register(0x30), 0xFF);
}

TEST_F(SimulatedIcm42688Test, StreamDropsTheOldestAndSaysFull) {
  enable_fifo();
  power_up();
  chip_.read_register(0x2D);
  for (int i = 0; i < 255; ++i) measure_x(0.0F);
  EXPECT_EQ(chip_.read_register(0x2D) & 0x02U, 0x00U);
  measure_x(10.0F);
  EXPECT_EQ(chip_.read_register(0x2D) & 0x02U, 0x02U);
  EXPECT_EQ(read_word(0x2E), 2048);
  for (int i = 0; i < 255; ++i) measure_x(0.0F);
  EXPECT_EQ(read_word(0x2E), 2048);
  EXPECT_EQ(pop_packet()[1], 0x05) << "the oldest left is that of 10 deg/s";
}

TEST_F(SimulatedIcm42688Test, ALevelReadsAsZeroOnceAfterAFlush) {
  enable_fifo();
  power_up();
  measure_x(1.0F);
  chip_.write_register(0x4B, 0x02);
  measure_x(2.0F);
  EXPECT_EQ(read_word(0x2E), 0);
  EXPECT_EQ(read_word(0x2E), 8);
}

TEST_F(SimulatedIcm42688Test, PartOfAPacketGoesOnOrComesAgain) {
  for (const bool goes_on : {false, true}) {
    enable_fifo();
    power_up();
    chip_.write_register(0x5F, goes_on ? 0x46 : 0x06);
    measure_x(10.0F);
    EXPECT_EQ(chip_.read_register(0x30), 0x20);
    chip_.read_register(0x2D);
    EXPECT_EQ(chip_.read_register(0x30), goes_on ? 0x05 : 0x20);
    chip_.write_register(0x16, 0x00);
  }
}

TEST_F(SimulatedIcm42688Test, TheThermometerCanBeOff) {
  power_up();
  chip_.write_register(0x4E, 0x2C);
  chip_.measure({}, core::Temperature::from_degc(35.0F));
  EXPECT_EQ(read_word(0x1D), -32768);
  chip_.write_register(0x4E, 0x0C);
  chip_.measure({}, core::Temperature::from_degc(35.0F));
  EXPECT_EQ(read_word(0x1D), 1325);
}

TEST_F(SimulatedIcm42688Test, OtherBanksHideTheRegisters) {
  chip_.write_register(0x76, 1);
  EXPECT_EQ(chip_.read_register(0x75), 0x00);
  EXPECT_EQ(chip_.read_register(0x76), 0x01);
  chip_.write_register(0x76, 0);
  EXPECT_EQ(chip_.read_register(0x75), 0x47);
}

TEST_F(SimulatedIcm42688Test, SoftwareResetTakesAMillisecond) {
  power_up();
  chip_.write_register(0x11, 0x01);
  EXPECT_FALSE(chip_.is_powered());
  chip_.write_register(0x4F, 0x68);  // refused: still in reset
  EXPECT_EQ(chip_.read_register(0x4F), 0x06);
  clock_.advance(core::Duration::milliseconds(1));
  chip_.write_register(0x4F, 0x68);
  EXPECT_EQ(chip_.read_register(0x4F), 0x68);
}

TEST_F(SimulatedIcm42688Test, CountsWritesToUnlistedAddresses) {
  chip_.write_register(0x75, 0x00);
  chip_.write_register(0x25, 0x00);
  EXPECT_EQ(chip_.reserved_writes(), 0U);
  chip_.write_register(0x12, 0xFF);
  EXPECT_EQ(chip_.reserved_writes(), 1U);
  EXPECT_EQ(chip_.read_register(0x75), 0x47);
}

TEST_F(SimulatedIcm42688Test, PeriodIsThatOfTheRate) {
  EXPECT_EQ(chip_.sample_period(), core::Duration{});
  power_up(0x68);
  EXPECT_EQ(chip_.sample_period(), core::Duration::milliseconds(10));
  power_up(0x6B);
  EXPECT_EQ(chip_.sample_period(), core::Duration::milliseconds(80));
  power_up(0x6F);
  EXPECT_EQ(chip_.sample_period(), core::Duration::milliseconds(2));
  power_up(0x65);
  EXPECT_EQ(chip_.sample_period(), core::Duration::microseconds(500));
}

TEST_F(SimulatedIcm42688Test, TheFirst30MillisecondsAreOff) {
  chip_.write_register(0x4F, 0x68);
  chip_.write_register(0x4E, 0x0C);
  clock_.advance(core::Duration::milliseconds(15));
  measure_x(0.0F);
  EXPECT_NEAR(read_word(0x25), 10.0 * 131.072, 1.0);  // half of 20 deg/s
  clock_.advance(core::Duration::milliseconds(15));
  measure_x(0.0F);
  EXPECT_EQ(read_word(0x25), 0);
}

}  // namespace
}  // namespace zerorate::hal::sim

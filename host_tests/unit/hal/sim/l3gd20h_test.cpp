/// @file
/// The simulated chip against what is known of the real one, register by register.

#include "hal/sim/l3gd20h.hpp"

#include <gtest/gtest.h>

#include <array>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;

class SimulatedL3gd20hTest : public ::testing::Test {
 protected:
  void SetUp() override { clock_.advance(core::Duration::seconds(1)); }
  void power_up(std::uint8_t ctrl1 = 0x0F) {
    chip_.write_register(0x20, ctrl1);
    clock_.advance(core::Duration::seconds(1));
  }
  void enable_fifo(std::uint8_t fifo_ctrl = 0x43) {
    chip_.write_register(0x24, 0x40);
    chip_.write_register(0x2E, fifo_ctrl);
  }
  void measure_x(float dps) {
    chip_.measure({deg_per_s(dps), {}, {}}, core::Temperature::from_degc(25.0F));
  }
  std::int16_t read_x() {
    const unsigned low = chip_.read_register(0x28);
    return static_cast<std::int16_t>(low | (unsigned{chip_.read_register(0x29)} << 8U));
  }
  /// A burst as a bus makes it.
  std::int16_t pop_x() {
    std::uint8_t address = 0x68;
    std::array<unsigned, 6> bytes{};
    for (unsigned& byte : bytes) {
      byte = chip_.read_register(address);
      address = chip_.next_address(address);
    }
    EXPECT_EQ(address, 0x68) << "back at OUT_X_L";
    return static_cast<std::int16_t>(bytes[0] | (bytes[1] << 8U));
  }

  SimulatedClock clock_;
  SimulatedL3gd20h chip_{clock_};
};

TEST_F(SimulatedL3gd20hTest, SaysWhoItIs) {
  EXPECT_EQ(chip_.read_register(0x0F), 0xD7);
  EXPECT_EQ(SimulatedL3gd20(clock_).read_register(0x0F), 0xD4);
  EXPECT_EQ(SimulatedL3g4200d(clock_).read_register(0x0F), 0xD3);
  EXPECT_EQ(chip_.read_register(0x20), 0x07);
  EXPECT_FALSE(chip_.is_powered());
}

TEST_F(SimulatedL3gd20hTest, MeasuresInThreeRanges) {
  constexpr std::array kLsbDps{0.00875, 0.0175, 0.07};
  for (std::size_t code = 0; code < kLsbDps.size(); ++code) {
    chip_.write_register(0x23, static_cast<std::uint8_t>(code << 4U));
    power_up();
    measure_x(static_cast<float>(1000.0 * kLsbDps.at(code)));
    EXPECT_EQ(read_x(), 1000);
  }
}

TEST_F(SimulatedL3gd20hTest, TurnsOnInAQuarterOfASecond) {
  chip_.write_register(0x20, 0x0F);
  clock_.advance(core::Duration::milliseconds(125));
  measure_x(0.0F);
  EXPECT_EQ(read_x(), 1143) << "10 deg/s";
  clock_.advance(core::Duration::milliseconds(125));
  measure_x(0.0F);
  EXPECT_EQ(read_x(), 0);
}

TEST_F(SimulatedL3gd20hTest, HasRatesOfItsOwn) {
  power_up(0x4F);
  EXPECT_EQ(chip_.sample_period(), core::Duration::milliseconds(5));
  chip_.write_register(0x39, 0x01);
  EXPECT_EQ(chip_.sample_period(), core::Duration::milliseconds(40));
  SimulatedL3gd20 older{clock_};
  older.write_register(0x20, 0x0F);
  EXPECT_EQ(older.sample_period().ns(), 10'526'315);
  older.write_register(0x39, 0x01);
  EXPECT_EQ(older.reserved_writes(), 1U) << "no LOW_ODR";
}

TEST_F(SimulatedL3gd20hTest, FlagsWhatIsNewAndWhatWasMissed) {
  power_up();
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x27), 0x0F);
  measure_x(1.0F);
  EXPECT_EQ(chip_.read_register(0x27), 0xFF);
  for (std::uint8_t address = 0x28; address <= 0x2D; ++address) chip_.read_register(address);
  EXPECT_EQ(chip_.read_register(0x27), 0x00);
}

TEST_F(SimulatedL3gd20hTest, FifoStreamsAndTellsThatItOverran) {
  enable_fifo();
  power_up();
  EXPECT_EQ(chip_.read_register(0x2F), 0x20);
  for (int i = 0; i < 31; ++i) measure_x(8.75F * static_cast<float>(i));
  EXPECT_EQ(chip_.read_register(0x2F), 0x9F);
  measure_x(0.0F);
  measure_x(0.0F);
  EXPECT_EQ(chip_.read_register(0x2F), 0xDF);
  EXPECT_EQ(pop_x(), 1000) << "the oldest is lost";
  EXPECT_EQ(pop_x(), 2000);
  EXPECT_EQ(chip_.read_register(0x2F), 0x9E);
  chip_.write_register(0x2E, 0x00);
  EXPECT_EQ(chip_.read_register(0x2F), 0x20) << "bypass empties it";
}

TEST_F(SimulatedL3gd20hTest, FifoInFifoModeKeepsTheOldest) {
  enable_fifo(0x20);
  power_up();
  for (int i = 0; i < 40; ++i) measure_x(8.75F * static_cast<float>(i));
  EXPECT_EQ(pop_x(), 0);
}

TEST_F(SimulatedL3gd20hTest, RaisesInt2AtTheWatermark) {
  enable_fifo();
  chip_.write_register(0x22, 0x04);
  power_up();
  measure_x(0.0F);
  measure_x(0.0F);
  EXPECT_FALSE(chip_.interrupt().level());
  measure_x(0.0F);
  EXPECT_TRUE(chip_.interrupt().level());
  pop_x();
  EXPECT_FALSE(chip_.interrupt().level());
}

TEST_F(SimulatedL3gd20hTest, BootsForFiveMilliseconds) {
  power_up();
  chip_.write_register(0x24, 0x80);
  EXPECT_FALSE(chip_.is_powered());
  clock_.advance(core::Duration::milliseconds(5));
  EXPECT_TRUE(chip_.is_powered()) << "registers stay";
  EXPECT_EQ(chip_.read_register(0x24), 0x00);
  chip_.write_register(0x39, 0x04);  // SW_RES
  EXPECT_FALSE(chip_.is_powered());
}

TEST_F(SimulatedL3gd20hTest, AddressesStayUnlessAskedToIncrement) {
  EXPECT_EQ(chip_.next_address(0x27), 0x27);
  EXPECT_EQ(chip_.next_address(0x67), 0x68);
  EXPECT_EQ(chip_.next_address(0xA7), 0xA8);
  EXPECT_EQ(chip_.next_address(0xAD), 0xAE) << "without the FIFO a burst goes on";
}

}  // namespace
}  // namespace zerorate::hal::sim

/// @file
/// The simulated chip against what is known of the real one, word by word.

#include "hal/sim/adis16475.hpp"

#include <gtest/gtest.h>

#include <array>

#include "hal/sim/buses.hpp"

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;

class SimulatedAdis16475Test : public ::testing::Test {
 protected:
  void wait_ms(std::int64_t ms) { clock_.advance(core::Duration::milliseconds(ms)); }
  std::uint16_t exchange(std::uint16_t word) {
    chip_.select();
    const std::uint16_t reply = chip_.reply();
    chip_.take(word);
    return reply;
  }
  /// The reply to a word, fetched by the next one.
  std::uint16_t ask(std::uint16_t word) {
    exchange(word);
    return exchange(0x7200);
  }
  void reset() {
    exchange(0xE880);
    exchange(0xE900);
  }
  void measure(float dps) {
    chip_.measure({deg_per_s(dps), deg_per_s(-dps), deg_per_s(0.0F)},
                  core::Temperature::from_degc(-12.5F));
  }
  /// The words of a burst, and one more.
  std::array<std::uint16_t, 11> burst() {
    exchange(0x6800);
    std::array<std::uint16_t, 11> words{};
    for (std::uint16_t& word : words) {
      word = chip_.reply();
      chip_.take(0);
    }
    return words;
  }

  SimulatedClock clock_;
  SimulatedAdis16475Part1 chip_{clock_};
};

TEST_F(SimulatedAdis16475Test, RepliesOneWordLate) {
  EXPECT_EQ(exchange(0x7200), 0U);
  EXPECT_EQ(exchange(0x6000), 16475U);
  EXPECT_EQ(exchange(0x5E00), 0x00C1U);
  EXPECT_EQ(exchange(0x5E00), 0x0003U);
}

TEST_F(SimulatedAdis16475Test, WritesByteByByte) {
  exchange(0xE4CF);
  exchange(0xE507);
  EXPECT_EQ(ask(0x6400), 0x07CFU);
  EXPECT_EQ(chip_.sample_period(), core::Duration::seconds(1));
  EXPECT_EQ(chip_.reserved_writes(), 0U);
}

TEST_F(SimulatedAdis16475Test, CountsWritesToWhatIsReserved) {
  exchange(0x8001);  // address 00h
  exchange(0xDA01);  // 5Ah
  EXPECT_EQ(chip_.reserved_writes(), 2U);
  exchange(0xF205);  // PROD_ID is read only
  EXPECT_EQ(chip_.reserved_writes(), 2U);
  EXPECT_EQ(ask(0x7200), 16475U);
}

TEST_F(SimulatedAdis16475Test, BurstsItsOutputsWithTheirSum) {
  wait_ms(1000);
  measure(1.0F);
  measure(100.0F);
  const auto words = burst();
  EXPECT_EQ(words[0], 0U);
  EXPECT_EQ(words[1], 16000U);
  EXPECT_EQ(words[2], 0x10000U - 16000U);
  EXPECT_EQ(words[3], 0U);
  EXPECT_EQ(words[6], 4000U) << "1 g along z";
  EXPECT_EQ(words[7], 0x10000U - 125U);
  EXPECT_EQ(words[8], 2U);
  unsigned sum = 0;
  for (std::size_t i = 0; i < 9; ++i) sum += (words.at(i) >> 8U) + (words.at(i) & 0xFFU);
  EXPECT_EQ(words[9], sum);
}

TEST_F(SimulatedAdis16475Test, ClipsAt16Bits) {
  wait_ms(1000);
  measure(1000.0F);
  const auto words = burst();
  EXPECT_EQ(words[1], 0x7FFFU);
  EXPECT_EQ(words[2], 0x8000U);
}

TEST_F(SimulatedAdis16475Test, ForgetsEverythingInAResetAndIsSilent) {
  wait_ms(1000);
  exchange(0xE413);
  measure(1.0F);
  reset();
  EXPECT_FALSE(chip_.is_powered());
  EXPECT_EQ(ask(0x7200), 0U);
  measure(1.0F);
  wait_ms(200);
  EXPECT_TRUE(chip_.is_powered());
  EXPECT_EQ(ask(0x7200), 16475U);
  EXPECT_EQ(ask(0x6400), 0U);
  EXPECT_EQ(burst()[8], 0U) << "nothing is measured during a reset";
}

TEST_F(SimulatedAdis16475Test, IsSilentAfterPowerOn) {
  chip_.cycle_power();
  wait_ms(249);
  EXPECT_EQ(ask(0x7200), 0U);
  wait_ms(1);
  EXPECT_EQ(ask(0x7200), 16475U);
}

TEST_F(SimulatedAdis16475Test, ErrsWhileItStarts) {
  wait_ms(1000);
  reset();
  wait_ms(200);
  measure(0.0F);
  EXPECT_EQ(burst()[3], 20U * 160U);
  wait_ms(120);
  measure(0.0F);
  EXPECT_EQ(burst()[3], 0U);
}

TEST_F(SimulatedAdis16475Test, ShowsFaultsUntilTheStatusIsRead) {
  chip_.fail(0x0020);
  EXPECT_EQ(ask(0x0200), 0x0020U);
  EXPECT_EQ(ask(0x0200), 0U);
  chip_.fail(0x0002);
  EXPECT_EQ(burst()[0], 0x0002U);
  EXPECT_EQ(burst()[0], 0U);
}

TEST_F(SimulatedAdis16475Test, SignalsWithThePolarityThatIsSet) {
  wait_ms(1000);
  EXPECT_FALSE(chip_.interrupt().level());
  measure(1.0F);
  EXPECT_TRUE(chip_.interrupt().take_edge());
  measure(1.0F);
  EXPECT_TRUE(chip_.interrupt().take_edge()) << "it is inactive while the outputs change";
  EXPECT_TRUE(chip_.interrupt().level());
  exchange(0xE0C0);
  measure(1.0F);
  EXPECT_FALSE(chip_.interrupt().level());
}

TEST(SimulatedWordSpi, TakesWordsOf16Clocks) {
  SimulatedClock clock;
  SimulatedAdis16470 chip{clock};
  SimulatedWordSpi spi{chip};
  const std::array<std::uint8_t, 2> read{0x72, 0x00};
  std::array<std::uint8_t, 2> reply{};
  ASSERT_TRUE(spi.transaction(std::array{Operation::exchange(read, reply)}));
  ASSERT_TRUE(spi.transaction(std::array{Operation::exchange(read, reply)}));
  EXPECT_EQ(reply, (std::array<std::uint8_t, 2>{0x40, 0x56})) << "16470";
  // 24 clocks are no words, which the status of the chip shows.
  std::array<std::uint8_t, 1> odd{};
  ASSERT_TRUE(spi.transaction(std::array{Operation::write(read), Operation::read(odd)}));
  const std::array<std::uint8_t, 2> status{0x02, 0x00};
  ASSERT_TRUE(spi.transaction(std::array{Operation::exchange(status, reply)}));
  ASSERT_TRUE(spi.transaction(std::array{Operation::exchange(status, reply)}));
  EXPECT_EQ(reply, (std::array<std::uint8_t, 2>{0x00, 0x08}));
}

TEST(SimulatedWordSpi, TouchesNothingWithoutOperations) {
  SimulatedClock clock;
  SimulatedAdis16470 chip{clock};
  SimulatedWordSpi spi{chip};
  EXPECT_TRUE(spi.transaction({}));
}

}  // namespace
}  // namespace zerorate::hal::sim

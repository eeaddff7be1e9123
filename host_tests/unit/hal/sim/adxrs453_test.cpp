/// @file
/// The simulated chip against what is known of the real one, frame by frame.

#include "hal/sim/adxrs453.hpp"

#include <gtest/gtest.h>

#include <bit>

namespace zerorate::hal::sim {
namespace {

using core::deg_per_s;
constexpr std::uint32_t kSensorData = 0x20000000;

class SimulatedAdxrs453Test : public ::testing::Test {
 protected:
  void wait_ms(std::int64_t ms) { clock_.advance(core::Duration::milliseconds(ms)); }
  /// The reply to a command, fetched by the next one.
  std::uint32_t ask(std::uint32_t command) {
    chip_.exchange_frame(command);
    return chip_.exchange_frame(kSensorData);
  }
  static std::int16_t rate_of(std::uint32_t reply) {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>((reply >> 10U) & 0xFFFFU));
  }
  static unsigned status_of(std::uint32_t reply) { return (reply >> 26U) & 3U; }

  SimulatedClock clock_;
  SimulatedAdxrs453 chip_{clock_};
};

TEST_F(SimulatedAdxrs453Test, RepliesOneFrameLateAndFirstWithOne) {
  wait_ms(1000);
  EXPECT_EQ(chip_.exchange_frame(0x80180000), 0x00000001U);
  EXPECT_EQ((chip_.exchange_frame(kSensorData) >> 5U) & 0xFFFFU, 0x5202U);
}

TEST_F(SimulatedAdxrs453Test, EveryReplyHasBothParities) {
  wait_ms(1000);
  for (int lsb = -100; lsb <= 100; ++lsb) {
    const auto rate = deg_per_s(static_cast<float>(lsb) / 80.0F);
    chip_.measure({rate, rate, rate}, {});
    for (const std::uint32_t command : {kSensorData, 0x80180000U, 0x40000000U, 0U}) {
      const std::uint32_t reply = ask(command);
      EXPECT_EQ(std::popcount(reply) % 2, 1);
      EXPECT_EQ(std::popcount(reply >> 16U) % 2, 1);
    }
  }
}

TEST_F(SimulatedAdxrs453Test, HasNoValidDataInTheFirst100ms) {
  wait_ms(99);
  EXPECT_EQ(status_of(ask(kSensorData)), 0U);
  EXPECT_EQ(ask(0x80180000) & 0xEFFF0000U, 0x0E010000U) << "data unavailable";
  wait_ms(1);
  EXPECT_EQ(status_of(ask(kSensorData)), 1U);
}

TEST_F(SimulatedAdxrs453Test, GivesTheRateOfZIn80thsAndClipsAt400) {
  wait_ms(1000);
  const auto raw = [this](float dps) {
    chip_.measure({deg_per_s(99.0F), deg_per_s(99.0F), deg_per_s(dps)}, {});
    return rate_of(ask(kSensorData));
  };
  EXPECT_EQ(raw(0.0F), 0);
  EXPECT_EQ(raw(1.0F), 80);
  EXPECT_EQ(raw(-300.0F), -24000);
  EXPECT_EQ(raw(1e4F), 32000);
  EXPECT_EQ(raw(-1e4F), -32000);
}

TEST_F(SimulatedAdxrs453Test, ReturnsTheSequence) {
  wait_ms(1000);
  EXPECT_EQ(ask(0x60000001) >> 29U, 1U);
  EXPECT_EQ(ask(0xA0000001) >> 29U, 2U);
  EXPECT_EQ(ask(0x30000001) >> 29U, 4U);
}

TEST_F(SimulatedAdxrs453Test, ShowsEveryFaultTwiceAfterChkAndTheTime) {
  wait_ms(100);
  chip_.exchange_frame(0x20000003);
  wait_ms(50);
  chip_.exchange_frame(kSensorData);
  wait_ms(50);
  for (int reply = 0; reply < 2; ++reply) {
    const std::uint32_t shown = chip_.exchange_frame(kSensorData);
    EXPECT_EQ(shown & 0xFEU, 0xFEU);
    EXPECT_EQ(status_of(shown), 2U);
  }
  const std::uint32_t after = chip_.exchange_frame(kSensorData);
  EXPECT_EQ(after & 0xFEU, 0x00U);
  EXPECT_EQ(status_of(after), 1U);
}

TEST_F(SimulatedAdxrs453Test, KeepsAFaultUntilItsRegisterIsRead) {
  wait_ms(1000);
  chip_.upset(0x0B, 0x04);  // CST
  EXPECT_EQ(ask(kSensorData) & 0xFEU, 0x04U);
  EXPECT_EQ(status_of(ask(kSensorData)), 0U);
  EXPECT_EQ((ask(0x80140000) >> 5U) & 0xFFFFU, 0x0004U);
  EXPECT_EQ(ask(kSensorData) & 0xFEU, 0x00U);
}

TEST_F(SimulatedAdxrs453Test, RefusesBadParityAndWrites) {
  wait_ms(1000);
  EXPECT_EQ(ask(0x20000001) & 0xEFFF0000U, 0x0E040000U) << "SPI error";
  EXPECT_EQ(ask(0x40000000) & 0xEFFF0000U, 0x0E020000U) << "request error";
  EXPECT_EQ(chip_.reserved_writes(), 2U);
}

TEST_F(SimulatedAdxrs453Test, GivesFifthsOfADegreeAbout45) {
  wait_ms(1000);
  chip_.measure({}, core::Temperature::from_degc(25.0F));
  EXPECT_EQ((ask(0x80040001) >> 5U) & 0xFFFFU, static_cast<std::uint16_t>(-100 * 64));
}

TEST(SimulatedFrameSpi, TakesFramesOf32ClocksOnly) {
  SimulatedClock clock;
  SimulatedAdxrs453 chip{clock};
  SimulatedFrameSpi spi{chip};
  std::array<std::uint8_t, 3> three{0x20, 0x00, 0x00};
  ASSERT_TRUE(spi.transaction(std::array{Operation::exchange(three, three)}));
  EXPECT_EQ(three, (std::array<std::uint8_t, 3>{0xFF, 0xFF, 0xFF}));
  std::array<std::uint8_t, 4> four{0x20, 0x00, 0x00, 0x00};
  ASSERT_TRUE(spi.transaction(std::array{Operation::exchange(four, four)}));
  EXPECT_EQ(four, (std::array<std::uint8_t, 4>{0x00, 0x00, 0x00, 0x01}));
}

}  // namespace
}  // namespace zerorate::hal::sim

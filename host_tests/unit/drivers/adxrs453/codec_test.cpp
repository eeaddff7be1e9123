#include "drivers/adxrs453/codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace zerorate::drivers::adxrs453 {
namespace {

TEST(Adxrs453Commands, AreThoseOfTheDatasheet) {
  EXPECT_EQ(encode_sensor_data(0), 0x20000000U);
  EXPECT_EQ(kCheckCommand, 0x20000003U);
  EXPECT_EQ(encode_read(0x00), 0x80000000U);
  EXPECT_EQ(encode_read(0x0C), 0x80180000U);
  EXPECT_EQ(encode_read(0x02), 0x80040001U);
}

TEST(Adxrs453SensorDataCommand, CarriesTheSequenceInBits31And30And28) {
  EXPECT_EQ(encode_sensor_data(1), 0x60000001U);
  EXPECT_EQ(encode_sensor_data(2), 0xA0000001U);
  EXPECT_EQ(encode_sensor_data(4), 0x30000001U);
  EXPECT_EQ(encode_sensor_data(7), 0xF0000001U);
}

TEST(Adxrs453Commands, HaveAnOddNumberOfOnes) {
  for (unsigned address = 0; address < 0x80; ++address) {
    EXPECT_EQ(std::popcount(encode_read(static_cast<std::uint8_t>(address))) % 2, 1);
  }
  for (std::uint8_t sequence = 0; sequence < 8; ++sequence) {
    EXPECT_EQ(std::popcount(encode_sensor_data(sequence)) % 2, 1);
  }
}

/// Sequence 5, P0, valid, rate 1234h, no faults: 101 0 01 and the data; 11 ones, P1 is 0 after P0.
constexpr std::uint32_t kReply = 0xA4000000U | (0x1234U << 10U);

TEST(Adxrs453Parity, IsOddOverTheUpperHalfAndOverAll) {
  // Upper half A448h: 5 ones, so P0 is 0. Lower half D000h: 3 ones; 8 in all, so P1 is 1.
  EXPECT_EQ(kReply >> 16U, 0xA448U);
  EXPECT_EQ(kReply & 0xFFFFU, 0xD000U);
  EXPECT_TRUE(has_good_parity(kReply | 1U));
  EXPECT_FALSE(has_good_parity(kReply));
  for (unsigned bit = 0; bit < 32; ++bit) {
    EXPECT_FALSE(has_good_parity((kReply | 1U) ^ (1U << bit))) << bit;
  }
  EXPECT_FALSE(has_good_parity(0U));
  EXPECT_FALSE(has_good_parity(0xFFFFFFFFU));
}

TEST(Adxrs453SensorReply, HoldsSequenceStatusRateAndFaults) {
  const SensorReply reply = decode_sensor_reply(kReply | 0x80U | 1U);
  EXPECT_EQ(reply.sequence, 5);
  EXPECT_EQ(reply.status, Status::valid);
  EXPECT_EQ(reply.rate_raw, 0x1234);
  EXPECT_EQ(reply.faults, 0x80) << "the parity bit is not a fault";
  EXPECT_EQ(decode_sensor_reply(0x02000000U).rate_raw, std::numeric_limits<std::int16_t>::min());
  EXPECT_EQ(decode_sensor_reply(0x03FFFC00U).rate_raw, -1);
}

TEST(Adxrs453ReadReply, IsToldFromSensorDataWritesAndErrors) {
  EXPECT_TRUE(is_read_reply(0x4E000000U));
  EXPECT_TRUE(is_read_reply(0x5E0A4041U)) << "P0 is not looked at";
  EXPECT_FALSE(is_read_reply(0x2E000000U)) << "write";
  EXPECT_FALSE(is_read_reply(0x0E000000U)) << "error";
  EXPECT_FALSE(is_read_reply(kReply));
  EXPECT_EQ(decode_read_data(0x4E0A4040U), 0x5202);
}

TEST(Adxrs453Temperature, IsTenBitsAbout45Degrees) {
  EXPECT_EQ(decode_temperature(0x0000).degc(), 45.0F);
  EXPECT_NEAR(decode_temperature(0x0140).degc(), 46.0F, 1e-5F);
  EXPECT_NEAR(decode_temperature(static_cast<std::uint16_t>(-425 * 64)).degc(), -40.0F, 1e-5F);
  EXPECT_NEAR(decode_temperature(200 * 64).degc(), 85.0F, 1e-5F);
}

TEST(Adxrs453Lsb, IsOneEightiethOfADegreeASecond) {
  EXPECT_NEAR(kLsb.in(core::deg_per_s), 0.0125, 0.0125 * 4.0 * std::exp2(-24));
  EXPECT_EQ(kFullScaleRaw, 24000);
}

}  // namespace
}  // namespace zerorate::drivers::adxrs453

#include "drivers/lsm6dso/codec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace zerorate::drivers::lsm6dso {
namespace {

constexpr std::int16_t kMin = std::numeric_limits<std::int16_t>::min();
constexpr std::int16_t kMax = std::numeric_limits<std::int16_t>::max();

struct Range {
  FullScale full_scale;
  double full_scale_dps;
  double mdps_per_lsb;  // DS12140, table 2
};
constexpr std::array kRanges{
    Range{FullScale::dps_125, 125, 4.375}, Range{FullScale::dps_250, 250, 8.75},
    Range{FullScale::dps_500, 500, 17.5}, Range{FullScale::dps_1000, 1000, 35},
    Range{FullScale::dps_2000, 2000, 70}};

double rad_s(double mdps) {
  return mdps * 1e-3 * std::numbers::pi / 180.0;
}

TEST(Lsb, IsTheSensitivityOfTheDatasheetToFloatAccuracy) {
  // Three roundings in single precision: of the sensitivity, of pi / 180 and of their product; each
  // is at most 2^-24 of the value.
  const double tolerance = 3.0 * std::exp2(-24);
  for (const Range& range : kRanges) {
    const double expected = rad_s(range.mdps_per_lsb);
    EXPECT_NEAR(lsb(range.full_scale).in(core::rad_per_s), expected, expected * tolerance);
  }
}

TEST(FullScaleRaw, IsTheNominalFullScaleInEveryRange) {
  for (const Range& range : kRanges) {
    EXPECT_EQ(static_cast<int>(range.full_scale_dps * 1000.0 / range.mdps_per_lsb), kFullScaleRaw);
  }
}

TEST(Temperature, Is25DegreesAtZeroAnd256CountsADegree) {
  EXPECT_EQ(decode_temperature(0).degc(), 25.0F);
  EXPECT_EQ(decode_temperature(256).degc(), 26.0F);
  EXPECT_EQ(decode_temperature(-256 * 65).degc(), -40.0F);
  EXPECT_EQ(decode_temperature(kMin).degc(), -103.0F);
  EXPECT_EQ(decode_temperature(kMax).degc(), 153.0F - 1.0F / 256.0F);
}

TEST(Ctrl2G, HoldsRateAboveRange) {
  EXPECT_EQ(encode_ctrl2_g(OutputDataRate::hz_104, FullScale::dps_250), 0x40);
  EXPECT_EQ(encode_ctrl2_g(OutputDataRate::hz_416, FullScale::dps_125), 0x62);
  EXPECT_EQ(encode_ctrl2_g(OutputDataRate::hz_6664, FullScale::dps_2000), 0xAC);
}

TEST(FifoStatus, JoinsTheTenBitsOfTheLevel) {
  EXPECT_EQ(decode_fifo_status(0xFF, 0x03).words, 1023);
  EXPECT_EQ(decode_fifo_status(0x00, 0xE2).words, 512);
  EXPECT_FALSE(decode_fifo_status(0x00, 0xE2).is_overrun);
  EXPECT_TRUE(decode_fifo_status(0x00, 0xEA).is_overrun);
  EXPECT_TRUE(decode_fifo_status(0x00, 0xFB).is_plausible);
  EXPECT_FALSE(decode_fifo_status(0xFF, 0xFF).is_plausible);
}

TEST(GyroTag, NeedsTheSensorAndEvenParity) {
  EXPECT_TRUE(is_gyro_tag(0b00001'00'1));
  EXPECT_TRUE(is_gyro_tag(0b00001'01'0));
  EXPECT_TRUE(is_gyro_tag(0b00001'11'1));
  EXPECT_FALSE(is_gyro_tag(0b00001'00'0)) << "parity";
  EXPECT_FALSE(is_gyro_tag(0b00010'00'1)) << "accelerometer";
  EXPECT_FALSE(is_gyro_tag(0b00011'00'0)) << "temperature";
}

TEST(Period, FollowsTheOscillatorsTrim) {
  for (int code = 1; code <= 10; ++code) {
    for (const int trim : {-128, -1, 0, 1, 127}) {
      const double hz = 6667.0 * (1.0 + 0.0015 * trim) * std::exp2(code - 10);
      const auto period =
          decode_period(static_cast<OutputDataRate>(code), static_cast<std::int8_t>(trim));
      EXPECT_NEAR(static_cast<double>(period.ns()), 1e9 / hz, 1.0) << code << ' ' << trim;
    }
  }
}

TEST(SettlingTime, IsTheTurnOnTimeAndTheSamplesToDiscard) {
  const auto period = core::Duration::milliseconds(10);
  EXPECT_EQ(settling_time(OutputDataRate::hz_12_5, period), core::Duration::milliseconds(70 + 30));
  EXPECT_EQ(settling_time(OutputDataRate::hz_104, period), core::Duration::milliseconds(70 + 40));
  EXPECT_EQ(settling_time(OutputDataRate::hz_6664, period),
            core::Duration::milliseconds(70 + 5410));
}

}  // namespace
}  // namespace zerorate::drivers::lsm6dso

#include "drivers/icm42688/codec.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace zerorate::drivers::icm42688 {
namespace {

TEST(Icm42688Lsb, IsTheFullScaleByTwoToThe15) {
  double full_scale_dps = 2000.0;
  for (int code = 0; code < 8; ++code, full_scale_dps /= 2.0) {
    const double expected = full_scale_dps / 32768.0 * std::numbers::pi / 180.0;
    const double got = lsb(static_cast<FullScale>(code)).in(core::rad_per_s);
    // Roundings of pi / 180 and of the product, each at most 2^-24 of the value.
    EXPECT_NEAR(got, expected, expected * 2.0 * std::exp2(-24)) << code;
  }
}

TEST(Icm42688Lsb, AgreesWithTheThreeDigitsOfTheDatasheet) {
  constexpr std::array kLsbPerDps{16.4, 32.8, 65.5, 131.0, 262.0, 524.3, 1048.6, 2097.2};
  for (std::size_t code = 0; code < kLsbPerDps.size(); ++code) {
    const double dps = lsb(static_cast<FullScale>(code)).in(core::deg_per_s);
    EXPECT_NEAR(1.0 / dps, kLsbPerDps[code], 1e-3 * kLsbPerDps[code]);
  }
}

TEST(Icm42688Temperature, Is25DegreesAtZero) {
  EXPECT_EQ(decode_temperature(0).degc(), 25.0F);
  EXPECT_NEAR(decode_temperature(13248).degc(), 125.0F, 1e-4F);
  EXPECT_NEAR(decode_temperature(-6624).degc(), -25.0F, 1e-4F);
}

TEST(Icm42688FifoStatus, CountsCompletePackets) {
  EXPECT_EQ(decode_fifo_status(0x00, 0x00, 0x00).packets, 0);
  EXPECT_EQ(decode_fifo_status(0x00, 0x00, 0x07).packets, 0);
  EXPECT_EQ(decode_fifo_status(0x00, 0x00, 0x10).packets, 2);
  EXPECT_EQ(decode_fifo_status(0x00, 0x08, 0x00).packets, 256);
}

TEST(Icm42688FifoStatus, KnowsFullAndImpossible) {
  EXPECT_FALSE(decode_fifo_status(0x0C, 0x00, 0x08).is_full);
  EXPECT_TRUE(decode_fifo_status(0x02, 0x08, 0x00).is_full);
  EXPECT_TRUE(decode_fifo_status(0x7F, 0x08, 0x00).is_plausible);
  EXPECT_FALSE(decode_fifo_status(0x80, 0x00, 0x08).is_plausible);
  EXPECT_FALSE(decode_fifo_status(0x00, 0x08, 0x01).is_plausible);
  EXPECT_FALSE(decode_fifo_status(0xFF, 0xFF, 0xFF).is_plausible);
}

TEST(Icm42688FifoHeader, IsThatOfGyroAlone) {
  EXPECT_TRUE(is_gyro_header(0x20));
  EXPECT_TRUE(is_gyro_header(0x29)) << "time stamp, first after a change of rate";
  EXPECT_FALSE(is_gyro_header(0x80)) << "empty";
  EXPECT_FALSE(is_gyro_header(0x60)) << "with accelerometer";
  EXPECT_FALSE(is_gyro_header(0x40)) << "accelerometer alone";
  EXPECT_FALSE(is_gyro_header(0x30)) << "20 bits";
}

TEST(Icm42688GyroConfig0, HoldsRangeAboveRate) {
  EXPECT_EQ(encode_gyro_config0(OutputDataRate::hz_100, FullScale::dps_250), 0x68);
  EXPECT_EQ(encode_gyro_config0(OutputDataRate::hz_1000, FullScale::dps_2000), 0x06);
  EXPECT_EQ(encode_gyro_config0(OutputDataRate::hz_500, FullScale::dps_15_625), 0xEF);
}

TEST(Icm42688SamplePeriod, IsThatOfTheNamedRate) {
  EXPECT_EQ(sample_period(OutputDataRate::hz_12_5), core::Duration::milliseconds(80));
  EXPECT_EQ(sample_period(OutputDataRate::hz_25), core::Duration::milliseconds(40));
  EXPECT_EQ(sample_period(OutputDataRate::hz_50), core::Duration::milliseconds(20));
  EXPECT_EQ(sample_period(OutputDataRate::hz_100), core::Duration::milliseconds(10));
  EXPECT_EQ(sample_period(OutputDataRate::hz_200), core::Duration::milliseconds(5));
  EXPECT_EQ(sample_period(OutputDataRate::hz_500), core::Duration::milliseconds(2));
  EXPECT_EQ(sample_period(OutputDataRate::hz_1000), core::Duration::milliseconds(1));
  EXPECT_EQ(sample_period(OutputDataRate::hz_2000), core::Duration::microseconds(500));
}

}  // namespace
}  // namespace zerorate::drivers::icm42688

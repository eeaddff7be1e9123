#include "drivers/bmi088/codec.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace zerorate::drivers::bmi088 {
namespace {

TEST(Bmi088Lsb, IsTheSensitivityOfTheDatasheet) {
  constexpr std::array kLsbPerDps{16.384, 32.768, 65.536, 131.072, 262.144};
  for (std::size_t code = 0; code < kLsbPerDps.size(); ++code) {
    const double expected = 1.0 / kLsbPerDps[code];
    const double got = lsb(static_cast<FullScale>(code)).in(core::deg_per_s);
    // Roundings of pi / 180, of the product, and of both again on the way back.
    EXPECT_NEAR(got, expected, expected * 4.0 * std::exp2(-24)) << code;
  }
}

TEST(Bmi088FifoStatus, HoldsLevelAndOverrun) {
  EXPECT_EQ(decode_fifo_status(0x00).frames, 0);
  EXPECT_EQ(decode_fifo_status(0x64).frames, 100);
  EXPECT_FALSE(decode_fifo_status(0x64).is_overrun);
  EXPECT_TRUE(decode_fifo_status(0x64).is_plausible);
  EXPECT_EQ(decode_fifo_status(0xE4).frames, 100);
  EXPECT_TRUE(decode_fifo_status(0xE4).is_overrun);
  EXPECT_FALSE(decode_fifo_status(0x65).is_plausible);
  EXPECT_FALSE(decode_fifo_status(0xFF).is_plausible);
}

TEST(Bmi088SamplePeriod, IsThatOfTheNamedRate) {
  using enum OutputDataRate;
  EXPECT_EQ(sample_period(hz_2000_bandwidth_532), core::Duration::microseconds(500));
  EXPECT_EQ(sample_period(hz_2000_bandwidth_230), core::Duration::microseconds(500));
  EXPECT_EQ(sample_period(hz_1000_bandwidth_116), core::Duration::milliseconds(1));
  EXPECT_EQ(sample_period(hz_400_bandwidth_47), core::Duration::microseconds(2500));
  EXPECT_EQ(sample_period(hz_200_bandwidth_23), core::Duration::milliseconds(5));
  EXPECT_EQ(sample_period(hz_200_bandwidth_64), core::Duration::milliseconds(5));
  EXPECT_EQ(sample_period(hz_100_bandwidth_12), core::Duration::milliseconds(10));
  EXPECT_EQ(sample_period(hz_100_bandwidth_32), core::Duration::milliseconds(10));
}

}  // namespace
}  // namespace zerorate::drivers::bmi088

#include "drivers/common/raw_rates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace zerorate::drivers {
namespace {

constexpr std::int16_t kMin = std::numeric_limits<std::int16_t>::min();
constexpr std::int16_t kMax = std::numeric_limits<std::int16_t>::max();

GyroSample sample_of(std::int16_t x, std::int16_t y, std::int16_t z) {
  GyroSample sample;
  set_rates(sample, {x, y, z}, core::rad_per_s(0.1F), 28571);
  return sample;
}

TEST(RateOfRawZero, IsExactlyZero) {
  for (const auto rate : sample_of(0, 0, 0).rate) EXPECT_EQ(rate.in(core::rad_per_s), 0.0F);
}

TEST(RateOfRawExtremes, IsTheLsbTimesTheCount) {
  const GyroSample sample = sample_of(kMin, kMax, -1);
  // One rounding of the constant and one of the product, each at most 2^-24 of the value.
  const double tolerance = 2.0 * std::exp2(-24);
  EXPECT_NEAR(sample.rate[0].in(core::rad_per_s), -3276.8, 3276.8 * tolerance);
  EXPECT_NEAR(sample.rate[1].in(core::rad_per_s), 3276.7, 3276.7 * tolerance);
  EXPECT_NEAR(sample.rate[2].in(core::rad_per_s), -0.1, 0.1 * tolerance);
}

TEST(Saturation, BeginsAtFullScaleOnBothSides) {
  EXPECT_EQ(sample_of(0, 28570, -28570).saturated_axes, 0);
  EXPECT_EQ(sample_of(28571, 0, 0).saturated_axes, 0b001);
  EXPECT_EQ(sample_of(0, -28571, 0).saturated_axes, 0b010);
  EXPECT_EQ(sample_of(kMin, 0, kMax).saturated_axes, 0b101);
}

TEST(Saturation, OfTheSampleBeforeIsForgotten) {
  GyroSample sample = sample_of(kMax, kMax, kMax);
  set_rates(sample, {0, 0, 0}, core::rad_per_s(0.1F), 28571);
  EXPECT_EQ(sample.saturated_axes, 0);
}

TEST(Int16, IsTwosComplement) {
  EXPECT_EQ(decode_int16(0x34, 0x12), 0x1234);
  EXPECT_EQ(decode_int16(0xFF, 0xFF), -1);
  EXPECT_EQ(decode_int16(0x00, 0x80), kMin);
  EXPECT_EQ(decode_int16(0xFF, 0x7F), kMax);
}

}  // namespace
}  // namespace zerorate::drivers

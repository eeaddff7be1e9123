#include "core/base/numeric.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace zerorate::core {
namespace {

TEST(SquareRoot, DigitsGiveTheSameBitsAsTheProcessor) {
  std::mt19937 bits(20120416);
  for (int i = 0; i < 200'000; ++i) {
    const auto pattern = static_cast<std::uint32_t>(bits()) & 0x7FFFFFFFU;
    const auto x = std::bit_cast<float>(pattern);
    if (!is_finite(x) || x == 0.0F) continue;
    ASSERT_EQ(std::bit_cast<std::uint32_t>(detail::square_root_by_digits(x)),
              std::bit_cast<std::uint32_t>(std::sqrt(x)))
        << x;
  }
}

TEST(SquareRoot, EdgesOfTheRangeAreExact) {
  using Limits = std::numeric_limits<float>;
  for (const float x : {Limits::denorm_min(), Limits::min(), Limits::max(), 1.0F, 2.0F, 4.0F,
                        std::nextafter(1.0F, 0.0F), std::nextafter(4.0F, 5.0F)}) {
    EXPECT_EQ(detail::square_root_by_digits(x), std::sqrt(x)) << x;
    EXPECT_EQ(square_root(x), std::sqrt(x)) << x;
  }
  static_assert(square_root(9.0F) == 3.0F, "usable in constant expressions");
}

TEST(SquareRoot, WhatIsNoVarianceGivesZero) {
  EXPECT_EQ(square_root(0.0F), 0.0F);
  EXPECT_EQ(square_root(-1.0F), 0.0F);
  EXPECT_EQ(square_root(std::numeric_limits<float>::quiet_NaN()), 0.0F);
}

TEST(DecayShare, IsOneMinusExpToSinglePrecisionOverTwelveDecades) {
  for (double x = 1e-9; x < 1e3; x *= 1.07) {
    const auto arg = static_cast<float>(x);
    const double exact = -std::expm1(-static_cast<double>(arg));
    EXPECT_NEAR(static_cast<double>(one_minus_exp_neg(arg)) / exact, 1.0, 4e-7) << x;
  }
  EXPECT_EQ(one_minus_exp_neg(0.0F), 0.0F);
}

TEST(ToFloat, RoundsLikeTheProcessor) {
  std::mt19937_64 bits(64);
  for (int i = 0; i < 200'000; ++i) {
    // All lengths from 1 to 64 bits, both signs.
    const auto x = static_cast<std::int64_t>(bits()) >> (i % 64);
    ASSERT_EQ(to_float(x), static_cast<float>(x)) << x;
  }
}

TEST(ToFloat, TiesGoToTheEvenNeighbourAndTheEdgesAreExact) {
  using Limits = std::numeric_limits<std::int64_t>;
  constexpr std::int64_t kBase = std::int64_t{1} << 62;
  constexpr std::int64_t kHalf = std::int64_t{1} << 38;  // half the distance of floats above kBase
  for (const std::int64_t x :
       {std::int64_t{0}, std::int64_t{-1}, Limits::min(), Limits::max(),
        (std::int64_t{1} << 24) + 1, (std::int64_t{1} << 24) + 3, kBase + kHalf, kBase + kHalf + 1,
        kBase + kHalf - 1, kBase + 3 * kHalf}) {
    EXPECT_EQ(to_float(x), static_cast<float>(x)) << x;
  }
  static_assert(to_float(-3) == -3.0F, "usable in constant expressions");
}

TEST(IsFinite, KnowsNanAndInfinity) {
  using Limits = std::numeric_limits<float>;
  EXPECT_TRUE(is_finite(Limits::max()));
  EXPECT_TRUE(is_finite(-0.0F));
  EXPECT_FALSE(is_finite(Limits::infinity()));
  EXPECT_FALSE(is_finite(-Limits::infinity()));
  EXPECT_FALSE(is_finite(Limits::quiet_NaN()));
}

TEST(IsFinitePositive, HoldsForPositiveNumbersOnly) {
  using Limits = std::numeric_limits<float>;
  for (const float x : {Limits::denorm_min(), Limits::min(), 1.0F, Limits::max()}) {
    EXPECT_TRUE(is_finite_positive(x)) << x;
    EXPECT_FALSE(is_finite_positive(-x)) << x;
  }
  for (const float x : {0.0F, -0.0F, Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(),
                        -Limits::quiet_NaN()}) {
    EXPECT_FALSE(is_finite_positive(x)) << x;
  }
}

}  // namespace
}  // namespace zerorate::core

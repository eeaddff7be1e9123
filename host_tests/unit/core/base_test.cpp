// Times, units, numbers, results, checksums and the rotation of the Earth.

#include <gtest/gtest.h>

#include <zlib.h>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/attitude.hpp"
#include "core/base/complex.hpp"
#include "core/base/crc32.hpp"
#include "core/base/earth_rate.hpp"
#include "core/base/numeric.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"

namespace zerorate::core {
namespace {

TEST(InstantsOneDayApart, DifferByExactlyThatManyNanoseconds) {
  const Instant start = Instant::from_ns(1);
  const Instant end = start + Duration::seconds(86'400);
  EXPECT_EQ((end - start).ns(), 86'400'000'000'000);
  EXPECT_LT(start, end);
}

TEST(DurationQuotient, CountsWholePeriodsTowardsZero) {
  EXPECT_EQ(Duration::milliseconds(29) / Duration::milliseconds(10), 2);
  EXPECT_EQ(Duration::milliseconds(-29) / Duration::milliseconds(10), -2);
}

TEST(DurationInSeconds, IsSinglePrecision) {
  EXPECT_FLOAT_EQ(Duration::microseconds(9'615).in_seconds(), 0.009615F);
}

TEST(AngularRate, EntersAndLeavesByNamedUnits) {
  const AngularRate rate = deg_per_s(90.0F);
  EXPECT_FLOAT_EQ(rate.in(rad_per_s), 1.5707963F);
  EXPECT_FLOAT_EQ(rate.in(deg_per_h), 324'000.0F);
}

TEST(AngularRate, TimesTimeIsAnAngle) {
  const Angle turned = deg_per_s(2.0F) * Duration::milliseconds(500);
  EXPECT_FLOAT_EQ(turned.in(deg), 1.0F);
}

TEST(Temperature, DifferenceOfPointsIsNoPoint) {
  const auto rise = Temperature::from_degc(45.0F) - Temperature::from_degc(25.0F);
  static_assert(std::is_same_v<decltype(rise), const TemperatureDifference>);
  EXPECT_FLOAT_EQ(rise.in(kelvin), 20.0F);
}

static_assert(sizeof(AngularRate) == sizeof(float), "a quantity costs nothing");
static_assert(std::is_trivially_copyable_v<AngularRate>);

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

/// Chance that Student's t with so many degrees of freedom exceeds a limit: its density integrated
/// over the angle whose tangent is t / sqrt(f), by the trapezoidal rule.
double student_tail(double limit, double freedom) {
  constexpr int kSteps = 200'000;
  constexpr double kRightAngle = std::numbers::pi / 2.0;
  const double from = std::atan(limit / std::sqrt(freedom));
  const double step = (kRightAngle - from) / kSteps;
  double sum = 0.0;
  for (int k = 0; k <= kSteps; ++k) {
    const double share = k == 0 || k == kSteps ? 0.5 : 1.0;
    sum += share * std::pow(std::cos(from + k * step), freedom - 1.0);
  }
  return sum * step * std::exp(std::lgamma(0.5 * (freedom + 1.0)) - std::lgamma(0.5 * freedom)) /
         std::sqrt(std::numbers::pi);
}

TEST(StudentFactor, MakesStudentsTAsRareAsSixStandardDeviations) {
  const double rare = 0.5 * std::erfc(6.0 / std::numbers::sqrt2);
  for (const float freedom : {6.0F, 12.0F, 24.0F, 64.0F, 192.0F}) {
    const double limit = 6.0 * std::sqrt(static_cast<double>(student_factor(36.0F, freedom)));
    // Wallace's transformation bounds the tail from one side, within a factor of two to three.
    EXPECT_GT(student_tail(limit, static_cast<double>(freedom)), rare) << freedom;
    EXPECT_LT(student_tail(limit, static_cast<double>(freedom)), 3.0 * rare) << freedom;
  }
  EXPECT_NEAR(static_cast<double>(student_factor(36.0F, 1e6F)), 1.0, 1e-4);
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

enum class Refusal : unsigned char { empty, late };

Result<int, Refusal> half_of_even(int x) {
  if (x % 2 != 0) return Unexpected{Refusal::late};
  return x / 2;
}

TEST(ResultWithValue, GivesTheValueAndNoError) {
  const auto result = half_of_even(8);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(*result, 4);
  EXPECT_EQ(result.value_or(-1), 4);
}

TEST(ResultWithError, GivesTheErrorAndTheFallback) {
  const auto result = half_of_even(7);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error(), Refusal::late);
  EXPECT_EQ(result.value_or(-1), -1);
}

/// Verifies SR-MEM-06.
TEST(ResultWithError, ReadingTheValueIsAProgrammerError) {
  const auto result = half_of_even(7);
  EXPECT_DEATH((void)result.value(), "");
}

TEST(ResultOfVoid, IsSuccessUnlessToldOtherwise) {
  const Result<void, Refusal> fine;
  const Result<void, Refusal> refused = Unexpected{Refusal::empty};
  EXPECT_TRUE(fine.has_value());
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error(), Refusal::empty);
}

static_assert(sizeof(Result<void, Refusal>) == 2);

TEST(Crc32OfTheCheckString, IsTheCataloguedValue) {
  constexpr std::array<std::uint8_t, 9> kCheck{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  static_assert(crc32(kCheck) == 0xCBF43926U);  // CRC RevEng catalogue, CRC-32/ISO-HDLC
  static_assert(crc32({}) == 0U);
}

TEST(Crc32OfRandomBytes, IsThatOfZlibInOnePieceOrTwo) {
  std::mt19937 random{7};
  for (std::size_t size = 1; size < 300; ++size) {
    std::vector<std::uint8_t> bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const auto expected = ::crc32(0, bytes.data(), static_cast<unsigned>(size));
    EXPECT_EQ(crc32(bytes), expected);
    const std::size_t cut = random() % (size + 1);
    const std::span all{bytes};
    EXPECT_EQ(crc32(all.subspan(cut), crc32(all.first(cut))), expected);
  }
}

constexpr double kRotation_rad_s = 2.0 * std::numbers::pi / 86'164.0989;  // a sidereal day
constexpr double kTolerance_rad_s = 1e-5 * kRotation_rad_s;

TEST(EarthRate, IsTheRotationTimesTheSineOfTheLatitude) {
  for (int latitude_deg = -90; latitude_deg <= 90; ++latitude_deg) {
    const double latitude = latitude_deg * std::numbers::pi / 180.0;
    const EarthRate earth = earth_rate(static_cast<float>(latitude_deg), {});
    EXPECT_EQ(earth.vertical_rad_s[0], 0.0F);
    EXPECT_EQ(earth.vertical_rad_s[1], 0.0F);
    EXPECT_NEAR(double{earth.vertical_rad_s[2]}, kRotation_rad_s * std::sin(latitude),
                kTolerance_rad_s);
    EXPECT_EQ(earth.heading_variance_rad2_s2[2], 0.0F);
    const double level = kRotation_rad_s * std::cos(latitude);
    EXPECT_NEAR(double{earth.heading_variance_rad2_s2[0]}, level * level,
                2.0 * kTolerance_rad_s * kRotation_rad_s);
    EXPECT_EQ(earth.heading_variance_rad2_s2[0], earth.heading_variance_rad2_s2[1]);
  }
}

TEST(EarthRateOfAnAxisThatPointsDown, HasTheOtherSign) {
  const EarthRate up = earth_rate(60.0F, {.axis = 0});
  const EarthRate down = earth_rate(60.0F, {.axis = 0, .points_down = true});
  EXPECT_GT(up.vertical_rad_s[0], 0.0F);
  EXPECT_EQ(down.vertical_rad_s[0], -up.vertical_rad_s[0]);
  EXPECT_EQ(down.heading_variance_rad2_s2, up.heading_variance_rad2_s2);
}

TEST(SquaredMagnitude, IsThatOfBothParts) {
  EXPECT_EQ(squared_magnitude(-3.0F), 9.0F);
  EXPECT_EQ(squared_magnitude(Complex{3.0F, -4.0F}), 25.0F);
}

TEST(NumbersThatAreNear, DifferByNoMoreThanTheLimitOnEachPlace) {
  constexpr std::array kHere{1.0F, 2.0F};
  EXPECT_TRUE(are_near(kHere, {1.5F, 1.5F}, 0.25F));
  EXPECT_FALSE(are_near(kHere, {1.0F, 2.75F}, 0.25F));
  EXPECT_FALSE(are_near(kHere, {0.25F, 2.0F}, 0.25F));
}

TEST(AngleOfAVector, IsThatOfTheLibraryInEveryOctant) {
  for (int degree = -180; degree <= 180; ++degree) {
    const double angle = degree * std::numbers::pi / 180.0;
    const auto x = static_cast<float>(3.0 * std::cos(angle));
    const auto y = static_cast<float>(3.0 * std::sin(angle));
    EXPECT_NEAR(double{angle_of(y, x).in(rad)}, std::atan2(double{y}, double{x}), 1e-6) << degree;
  }
  EXPECT_EQ(angle_of(0.0F, 0.0F), Angle{});
}

TEST(AttitudeOfASensor, IsThatOfTheRotationsThatTiltedIt) {
  // Up in the sensor's axes, after a pitch and then a roll: the last row of the product of both.
  for (const auto& [roll_deg, pitch_deg] :
       {std::pair{0.0, 0.0}, {10.0, 0.0}, {0.0, -20.0}, {170.0, 35.0}, {-120.0, -80.0}}) {
    const double roll = roll_deg * std::numbers::pi / 180.0;
    const double pitch = pitch_deg * std::numbers::pi / 180.0;
    const Attitude attitude = attitude_of({static_cast<float>(-std::sin(pitch)),
                                           static_cast<float>(std::cos(pitch) * std::sin(roll)),
                                           static_cast<float>(std::cos(pitch) * std::cos(roll))});
    EXPECT_NEAR(attitude.roll.in(deg), roll_deg, 1e-3);
    EXPECT_NEAR(attitude.pitch.in(deg), pitch_deg, 1e-3);
    EXPECT_NEAR(attitude.tilt.in(rad), std::acos(std::cos(pitch) * std::cos(roll)), 1e-3);
  }
}

}  // namespace
}  // namespace zerorate::core

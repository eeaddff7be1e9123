// The mean of a vehicle that sways against its bias, and the error that it claims.

#include "core/standstill/sway_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::core {
namespace {

constexpr Duration kTick = Duration::milliseconds(500);
constexpr int kTicks = 96;

/// Feeds rate(seconds) for 48 s.
template <class Rate>
SwayMean<1> mean_of(Rate rate) {
  SwayMean<1> sway{kTick};
  for (int k = 0; k < kTicks; ++k) {
    EXPECT_FALSE(sway.is_complete());
    sway.add({static_cast<float>(rate(0.5 * k))});
  }
  EXPECT_TRUE(sway.is_complete());
  return sway;
}

// 400 boats of another period, phase and amplitude each. A normal error lies beyond two of the
// claimed deviations less often than in one case of 22; the enlarged one is wider.
TEST(SwayMean, HasAnErrorThatHoldsTheBiasOfABoat) {
  const random::RandomStream numbers{11, 0};
  constexpr double kBias = 0.3;
  int beyond_two = 0;
  for (int boat = 0; boat < 400; ++boat) {
    const auto uniform = [&](int k) { return numbers.uniform(boat * 8 + k); };
    const double amplitude = 0.5 + 4.0 * uniform(0);
    const double frequency_hz = 0.05 + 0.4 * uniform(1);
    const double phase = 6.28 * uniform(2);
    const SwayMean<1> sway = mean_of([&](double t) {
      return kBias + amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * t + phase);
    });
    const double sigma = std::sqrt(double{sway.variance_rad2_s2()});
    const double error = std::abs(double{sway.mean_rad_s()[0]} - kBias);
    EXPECT_LT(error, 5.0 * sigma) << boat;
    EXPECT_LT(sigma, 1.2 * amplitude);
    if (error > 2.0 * sigma) ++beyond_two;
  }
  EXPECT_LE(beyond_two, 400 / 22);
}

// Parts of 6 s with the means 2.75, 8.75, ... 44.75, whose squared deviations add up to 36 x 42.
TEST(SwayMean, IsThatOfAllTicksWithTheVarianceOfItsParts) {
  const SwayMean<1> sway = mean_of([](double t) { return t; });
  EXPECT_FLOAT_EQ(sway.mean_rad_s()[0], 23.75F);
  EXPECT_FLOAT_EQ(sway.variance_rad2_s2(), 36.0F * 42.0F / 7.0F);
}

TEST(SwayMean, DoesNotTakeATurnForSway) {
  EXPECT_TRUE(mean_of([](double t) { return 0.3 + std::sin(t); }).sways());
  // A roundabout, and a bend that ends.
  EXPECT_FALSE(mean_of([](double t) { return 20.0 + std::sin(t); }).sways());
  EXPECT_FALSE(mean_of([](double t) { return t < 40.0 ? 10.0 : 0.0; }).sways());
}

TEST(SwayMean, IsAsUncertainAsOneTurnMakesIt) {
  const SwayMean<1> sway = mean_of([](double t) { return t < 6.0 ? 10.0 : 0.0; });
  const double sigma = std::sqrt(double{sway.variance_rad2_s2()});
  EXPECT_GT(sigma, double{sway.mean_rad_s()[0]});
}

TEST(SwayMean, GoesOnFromItsState) {
  SwayMean<1> one{kTick};
  SwayMean<1> other{kTick};
  for (int k = 0; k < 50; ++k) one.add({static_cast<float>(k)});
  other.restore(one.state());
  for (int k = 0; k < 46; ++k) {
    one.add({1.0F});
    other.add({1.0F});
  }
  EXPECT_TRUE(SwayMean<1>::is_possible(other.state()));
  EXPECT_EQ(one.state(), other.state());
  EXPECT_TRUE(other.is_complete());
}

}  // namespace
}  // namespace zerorate::core

// Effects on the bias, each alone: found where it is, and not found where it is not.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <cmath>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

TEST(BiasJumpAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_bias_jump(),
                          record_with({simulate::BiasJump{0.08 * kRadPerDeg, 300.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("height_dps", 0.08);
  alone.expect_within_three_sigma("time_s", 300.0);
  EXPECT_TRUE(alone.model().rate_random_walk);
}

TEST(BiasJumpAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_bias_jump(), record_with({})).is_found());
}

TEST(RelaxationAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(
      make_relaxation(),
      record_with({simulate::Relaxation{
          {{100.0, 0.2 * kRadPerDeg}, {250.0, -0.3 * kRadPerDeg}, {400.0, 0.15 * kRadPerDeg}},
          20.0}}));
  ASSERT_TRUE(alone.is_found());
  EXPECT_EQ(alone.value_of("jumps"), 3.0);
  alone.expect_within_three_sigma("largest_height_dps", -0.3);
  EXPECT_NEAR(alone.value_of("largest_time_s"), 250.0, 2.0);
  EXPECT_NEAR(alone.value_of("time_constant_s"), 20.0, 6.0);
  ASSERT_EQ(alone.model().gauss_markov.size(), 1U);
  // Half of 3 / 500 s times 20 s times the mean square of the heights, (0.225 deg/s)^2.
  EXPECT_NEAR(alone.model().gauss_markov.front().sigma_rad_s, 0.055 * kRadPerDeg,
              0.012 * kRadPerDeg);
}

// The end of a record cuts a long decay off, and slow noise that ends there does not look like one.
TEST(RelaxationAlone, IsFoundInStrongFlickerNoise) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const EffectAlone alone(
        make_relaxation(),
        record_with(
            {simulate::FlickerNoise{100.0 / 3600.0 * kRadPerDeg, 0.5},
             simulate::Relaxation{{{150.0, 0.25 * kRadPerDeg}, {330.0, -0.25 * kRadPerDeg}}, 10.0}},
            seed));
    found += alone.is_found() ? 1 : 0;
  }
  EXPECT_EQ(found, 20);
}

TEST(RelaxationAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_relaxation(), record_with({})).is_found());
}

TEST(RateRampAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_rate_ramp(), record_with({simulate::RateRamp{6e-4 * kRadPerDeg}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("slope_dps_per_s", 6e-4);
  EXPECT_TRUE(alone.model().rate_ramp);
}

TEST(RateRampAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_rate_ramp(), record_with({})).is_found());
}

TEST(WarmUpTransientAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_warm_up_transient(),
                          record_with({simulate::WarmUpTransient{0.3 * kRadPerDeg, 60.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("amplitude_dps", 0.3);
  alone.expect_within_three_sigma("time_constant_s", 60.0);
  EXPECT_TRUE(alone.model().warm_up);
}

TEST(WarmUpTransientAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_warm_up_transient(), record_with({})).is_found());
}

/// A record whose temperature swings by `reach_k`, with the bias following it.
Record warmed(double reach_k, double slope_dps_per_k) {
  Record record = record_with({});
  for (std::size_t k = 0; k < record.size(); ++k) {
    const double excess = reach_k * std::sin(0.02 * record.time_s[k]);
    record.temperature_degc.push_back(25.0 + excess);
    record.rate_rad_s[k] += slope_dps_per_k * kRadPerDeg * excess;
  }
  return record;
}

TEST(TemperatureDriftAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_temperature_drift(), warmed(5.0, 0.02));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("linear_dps_per_k", 0.02);
  EXPECT_TRUE(alone.model().temperature);
}

TEST(TemperatureDriftAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_temperature_drift(), warmed(5.0, 0.0)).is_found());
}

TEST(TemperatureRateAlone, IsFoundWithItsFigures) {
  // The rate of 5 K sin(0.02 t) behind 20 s: 0.1 K/s cos(0.02 t - atan(0.4)) / hypot(1, 0.4).
  constexpr double kLag_s = 20.0;
  constexpr double kCoefficient_deg_per_k = 1.0;
  Record record = warmed(5.0, 0.0);
  const double reach_k_per_s = 0.1 / std::hypot(1.0, 0.02 * kLag_s);
  for (std::size_t k = 0; k < record.size(); ++k) {
    const double phase = 0.02 * record.time_s[k] - std::atan(0.02 * kLag_s);
    record.rate_rad_s[k] += kCoefficient_deg_per_k * kRadPerDeg * reach_k_per_s * std::cos(phase);
  }
  const EffectAlone alone(make_temperature_rate(), record);
  ASSERT_TRUE(alone.is_found());
  // A lag that is off by half a step of its grid, 1.26, changes the strength by 1 / hypot(1, 0.5).
  const double found = alone.value_of("coefficient_deg_per_k");
  EXPECT_NEAR(found, kCoefficient_deg_per_k, 0.15);
  ASSERT_EQ(alone.model().gauss_markov.size(), 1U);
  EXPECT_NEAR(alone.model().gauss_markov.front().sigma_rad_s,
              kCoefficient_deg_per_k * kRadPerDeg * reach_k_per_s / std::sqrt(2.0),
              0.1 * kRadPerDeg * reach_k_per_s);
  // cos falls to 1/e at 1.19 rad.
  EXPECT_NEAR(alone.model().gauss_markov.front().time_constant_s, 1.19 / 0.02, 10.0);
}

TEST(TemperatureRateAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_temperature_rate(), warmed(5.0, 0.0)).is_found());
}

TEST(TemperatureDriftAlone, CannotBeExaminedWithoutATemperature) {
  const EffectAlone alone(make_temperature_drift(), record_with({}));
  EXPECT_EQ(alone.obstacle(), "no temperature");
  EXPECT_FALSE(alone.is_found());
}

TEST(TemperatureDriftAlone, NeedsAChangingTemperature) {
  EXPECT_EQ(EffectAlone(make_temperature_drift(), warmed(0.01, 0.0)).obstacle(),
            "the temperature hardly changes");
}

TEST(PeriodicDisturbanceAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_periodic_disturbance(),
                          record_with({simulate::PeriodicDisturbance{0.03 * kRadPerDeg, 0.7}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("amplitude_dps", 0.03);
  alone.expect_within_three_sigma("frequency_hz", 0.7);
  EXPECT_THAT(alone.sentence(), ::testing::HasSubstr(" Hz, a period of 1.4"));
  EXPECT_EQ(alone.model().harmonic.size(), 1U);
}

TEST(PeriodicDisturbanceAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_periodic_disturbance(), record_with({})).is_found());
}

}  // namespace
}  // namespace zerorate::diagnose

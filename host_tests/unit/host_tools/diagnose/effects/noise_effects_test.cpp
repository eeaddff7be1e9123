// Effects of noise, each alone: found where it is, and not found where it is not.

#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

TEST(CorrelatedNoiseAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_correlated_noise(),
                          record_with({simulate::CorrelatedNoise{0.1 * kRadPerDeg, 2.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("sigma_dps", 0.1);
  alone.expect_within_three_sigma("time_constant_s", 2.0);
  EXPECT_EQ(alone.model().gauss_markov.size(), 1U);
}

TEST(CorrelatedNoiseAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_correlated_noise(), record_with({})).is_found());
}

TEST(FractionalOrderAlone, IsFoundWithItsFigures) {
  const simulate::Signal signal = zerorate::testing::simulate_rest(
      {.bias_instability_dph = 400.0, .order = 0.8}, kSamples, kPeriod_s, 3);
  const EffectAlone alone(make_fractional_order(),
                          record_of(zerorate::testing::rest_samples_of(signal), 0));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("order", 0.8);
}

TEST(FractionalOrderAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_fractional_order(), record_with({})).is_found());
}

TEST(RateRandomWalkAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_rate_random_walk(),
                          record_with({simulate::RateRandomWalk{8e-3 * kRadPerDeg}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("coefficient_dps_per_sqrt_s", 8e-3);
  EXPECT_TRUE(alone.model().rate_random_walk);
}

TEST(RateRandomWalkAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_rate_random_walk(), record_with({})).is_found());
}

TEST(RandomTelegraphNoiseAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(
      make_random_telegraph_noise(),
      record_with({simulate::RandomTelegraphNoise{0.2 * kRadPerDeg, 20.0, 20.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("height_dps", 0.2);
  alone.expect_within_three_sigma("mean_low_s", 20.0);
  alone.expect_within_three_sigma("mean_high_s", 20.0);
  EXPECT_EQ(alone.model().gauss_markov.size(), 1U);
}

TEST(RandomTelegraphNoiseAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_random_telegraph_noise(), record_with({})).is_found());
}

TEST(VariableNoiseAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_variable_noise(),
                          record_with({simulate::VariableNoise{0.08 * kRadPerDeg, 200.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("swing_period_s", 200.0);
  EXPECT_TRUE(alone.model().variable_noise);
}

TEST(VariableNoiseAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_variable_noise(), record_with({})).is_found());
}

TEST(VariableNoiseAlone, CannotBeExaminedInMeansOverTicks) {
  const EffectAlone alone(make_variable_noise(), series_of_ticks());
  EXPECT_EQ(alone.obstacle(), "samples too uneven");
  EXPECT_FALSE(alone.is_found());
}

TEST(VariableNoiseAlone, CannotBeExaminedOnCoarseLevels) {
  const EffectAlone alone(make_variable_noise(),
                          record_with({simulate::Quantization{0.4 * kRadPerDeg}}));
  EXPECT_EQ(alone.obstacle(), "levels too coarse");
}

}  // namespace
}  // namespace zerorate::diagnose

// Effects of noise and on samples, each alone: found where it is, and not found where it is not.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

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

TEST(SensorBandwidthAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_sensor_bandwidth(), record_with({simulate::SensorBandwidth{1.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("cut_off_hz", 1.0);
}

TEST(SensorBandwidthAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_sensor_bandwidth(), record_with({})).is_found());
}

TEST(MotionContaminationAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(
      make_motion_contamination(),
      record_with({simulate::MotionContamination{1.5 * kRadPerDeg, 200.0, 2.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("peak_sigma_dps", 1.5);
  alone.expect_within_three_sigma("duration_s", 2.0);
  EXPECT_TRUE(alone.model().motion_contamination);
}

TEST(MotionContaminationAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_motion_contamination(), record_with({})).is_found());
}

TEST(QuantizationAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_quantization(),
                          record_with({simulate::Quantization{0.1 * kRadPerDeg}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("step_dps", 0.1);
  EXPECT_TRUE(alone.model().quantization);
}

TEST(QuantizationAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_quantization(), record_with({})).is_found());
}

TEST(QuantizationAlone, CannotBeExaminedInMeansOverTicks) {
  const EffectAlone alone(make_quantization(), series_of_ticks());
  EXPECT_EQ(alone.obstacle(), "samples too uneven");
  EXPECT_FALSE(alone.is_found());
}

TEST(SaturationAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_saturation(), record_with({simulate::Saturation{0.4 * kRadPerDeg}}));
  ASSERT_TRUE(alone.is_found());
  // The end is read off the record, in single precision.
  ASSERT_FALSE(alone.description().parameters.empty());
  EXPECT_NEAR(alone.description().parameters.back().value, 0.4, 1e-7);
  EXPECT_TRUE(alone.model().saturation);
}

TEST(SaturationAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_saturation(), record_with({})).is_found());
}

TEST(SaturationAlone, CannotBeExaminedInMeansOverTicks) {
  const EffectAlone alone(make_saturation(), series_of_ticks());
  EXPECT_EQ(alone.obstacle(), "samples too uneven");
  EXPECT_FALSE(alone.is_found());
}

TEST(OutliersAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_outliers(),
                          record_with({simulate::Outliers{1.0 * kRadPerDeg, 5e-3}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("sigma_dps", 1.0);
  alone.expect_within_three_sigma("probability", 5e-3);
  EXPECT_TRUE(alone.model().outliers);
}

// Wild values of one size are unlike the model's normal ones, which reach into the noise.
TEST(OutliersAlone, HasEightOfOneSizeInTheInterval) {
  int tried = 0;
  int inside = 0;
  for (const double size_dps : {1.0, 1.5, 6.0}) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      simulate::Signal signal = zerorate::testing::simulate_rest({}, kSamples, kPeriod_s, seed);
      for (std::size_t k = 0; k < 8; ++k) {
        signal.rate_rad_s[300 + 570 * k] += (k % 2 == 0 ? size_dps : -size_dps) * kRadPerDeg;
      }
      const EffectAlone alone(make_outliers(),
                              record_of(zerorate::testing::rest_samples_of(signal), 0));
      if (!alone.is_found()) continue;
      ++tried;
      if (alone.is_inside("count", 8.0)) ++inside;
    }
  }
  EXPECT_GE(tried, 16);  // those of 1.5 and 6 deg/s
  const double standard_deviation = std::sqrt(0.95 * 0.05 * tried);
  EXPECT_GE(inside, 0.95 * tried - 3.0 * standard_deviation);
}

TEST(OutliersAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_outliers(), record_with({})).is_found());
}

TEST(OutliersAlone, CannotBeExaminedInMeansOverTicks) {
  const EffectAlone alone(make_outliers(), series_of_ticks());
  EXPECT_EQ(alone.obstacle(), "samples too uneven");
  EXPECT_FALSE(alone.is_found());
}

TEST(DroppedSamplesAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_dropped_samples(),
                          record_with({simulate::DroppedSamples{0.02, 2.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("mean_run_samples", 2.0);
}

TEST(DroppedSamplesAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_dropped_samples(), record_with({})).is_found());
}

}  // namespace
}  // namespace zerorate::diagnose

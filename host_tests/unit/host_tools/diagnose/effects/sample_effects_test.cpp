// Effects on samples, each alone: found where it is, and not found where it is not.

#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

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

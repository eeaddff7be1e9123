#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

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

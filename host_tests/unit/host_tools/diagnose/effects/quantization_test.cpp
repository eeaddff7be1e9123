#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

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

}  // namespace
}  // namespace zerorate::diagnose

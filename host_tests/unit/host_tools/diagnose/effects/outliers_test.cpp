#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

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

}  // namespace
}  // namespace zerorate::diagnose

#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

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

}  // namespace
}  // namespace zerorate::diagnose

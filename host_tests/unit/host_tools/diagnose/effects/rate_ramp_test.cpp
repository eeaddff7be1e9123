#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

TEST(RateRampAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_rate_ramp(), record_with({simulate::RateRamp{6e-4 * kRadPerDeg}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("slope_dps_per_s", 6e-4);
  EXPECT_TRUE(alone.model().rate_ramp);
}

TEST(RateRampAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_rate_ramp(), record_with({})).is_found());
}

}  // namespace
}  // namespace zerorate::diagnose

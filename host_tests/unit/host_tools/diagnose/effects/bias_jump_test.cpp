#include <gtest/gtest.h>

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

}  // namespace
}  // namespace zerorate::diagnose

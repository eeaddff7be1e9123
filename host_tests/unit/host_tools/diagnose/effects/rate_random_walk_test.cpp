#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

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

}  // namespace
}  // namespace zerorate::diagnose

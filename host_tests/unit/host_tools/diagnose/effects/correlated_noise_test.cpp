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

}  // namespace
}  // namespace zerorate::diagnose

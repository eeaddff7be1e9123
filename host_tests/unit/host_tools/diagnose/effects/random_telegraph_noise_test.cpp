#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

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

}  // namespace
}  // namespace zerorate::diagnose

#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

TEST(WarmUpTransientAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_warm_up_transient(),
                          record_with({simulate::WarmUpTransient{0.3 * kRadPerDeg, 60.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("amplitude_dps", 0.3);
  alone.expect_within_three_sigma("time_constant_s", 60.0);
  EXPECT_TRUE(alone.model().warm_up);
}

TEST(WarmUpTransientAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_warm_up_transient(), record_with({})).is_found());
}

}  // namespace
}  // namespace zerorate::diagnose

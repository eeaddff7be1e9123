#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

TEST(PeriodicDisturbanceAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_periodic_disturbance(),
                          record_with({simulate::PeriodicDisturbance{0.03 * kRadPerDeg, 0.7}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("amplitude_dps", 0.03);
  alone.expect_within_three_sigma("frequency_hz", 0.7);
  EXPECT_EQ(alone.model().harmonic.size(), 1U);
}

TEST(PeriodicDisturbanceAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_periodic_disturbance(), record_with({})).is_found());
}

}  // namespace
}  // namespace zerorate::diagnose

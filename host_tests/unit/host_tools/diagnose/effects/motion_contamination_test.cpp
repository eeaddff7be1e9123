#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

TEST(MotionContaminationAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(
      make_motion_contamination(),
      record_with({simulate::MotionContamination{1.5 * kRadPerDeg, 200.0, 2.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("peak_sigma_dps", 1.5);
  alone.expect_within_three_sigma("duration_s", 2.0);
  EXPECT_TRUE(alone.model().motion_contamination);
}

TEST(MotionContaminationAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_motion_contamination(), record_with({})).is_found());
}

}  // namespace
}  // namespace zerorate::diagnose

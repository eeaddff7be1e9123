#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

TEST(DroppedSamplesAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_dropped_samples(),
                          record_with({simulate::DroppedSamples{0.02, 2.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("mean_run_samples", 2.0);
}

TEST(DroppedSamplesAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_dropped_samples(), record_with({})).is_found());
}

}  // namespace
}  // namespace zerorate::diagnose

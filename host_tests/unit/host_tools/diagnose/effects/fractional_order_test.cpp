#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

TEST(FractionalOrderAlone, IsFoundWithItsFigures) {
  const simulate::Signal signal = zerorate::testing::simulate_rest(
      {.bias_instability_dph = 400.0, .order = 0.8}, kSamples, kPeriod_s, 3);
  const EffectAlone alone(make_fractional_order(),
                          record_of(zerorate::testing::rest_samples_of(signal), 0));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("order", 0.8);
}

TEST(FractionalOrderAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_fractional_order(), record_with({})).is_found());
}

}  // namespace
}  // namespace zerorate::diagnose

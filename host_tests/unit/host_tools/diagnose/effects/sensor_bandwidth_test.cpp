#include <gtest/gtest.h>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

TEST(SensorBandwidthAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_sensor_bandwidth(), record_with({simulate::SensorBandwidth{1.0}}));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("cut_off_hz", 1.0);
}

TEST(SensorBandwidthAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_sensor_bandwidth(), record_with({})).is_found());
}

}  // namespace
}  // namespace zerorate::diagnose

#include <gtest/gtest.h>

#include <cmath>

#include "host_tests/unit/host_tools/diagnose/effects/effect_alone.hpp"

namespace zerorate::diagnose {
namespace {

/// A record whose temperature swings by `reach_k`, with the bias following it.
Record warmed(double reach_k, double slope_dps_per_k) {
  Record record = record_with({});
  for (std::size_t k = 0; k < record.size(); ++k) {
    const double excess = reach_k * std::sin(0.02 * record.time_s[k]);
    record.temperature_degc.push_back(25.0 + excess);
    record.rate_rad_s[k] += slope_dps_per_k * kRadPerDeg * excess;
  }
  return record;
}

TEST(TemperatureDriftAlone, IsFoundWithItsFigures) {
  const EffectAlone alone(make_temperature_drift(), warmed(5.0, 0.02));
  ASSERT_TRUE(alone.is_found());
  alone.expect_within_three_sigma("linear_dps_per_k", 0.02);
  EXPECT_TRUE(alone.model().temperature);
}

TEST(TemperatureDriftAlone, IsNotFoundInWhiteAndFlickerNoise) {
  EXPECT_FALSE(EffectAlone(make_temperature_drift(), warmed(5.0, 0.0)).is_found());
}

TEST(TemperatureDriftAlone, CannotBeExaminedWithoutATemperature) {
  const EffectAlone alone(make_temperature_drift(), record_with({}));
  EXPECT_EQ(alone.obstacle(), "no temperature");
  EXPECT_FALSE(alone.is_found());
}

TEST(TemperatureDriftAlone, CannotBeExaminedWhereTheTemperatureHardlyChanges) {
  EXPECT_EQ(EffectAlone(make_temperature_drift(), warmed(0.01, 0.0)).obstacle(),
            "the temperature hardly changes");
}

}  // namespace
}  // namespace zerorate::diagnose

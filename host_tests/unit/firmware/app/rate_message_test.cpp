#include "firmware/app/rate_message.hpp"

#include <gtest/gtest.h>

#include <array>

namespace zerorate::app {
namespace {

/// Verifies SR-HEALTH-23, SR-HEALTH-24.
TEST(Health, IsUsableUnlessRateOrIntervalAreInDoubt) {
  EXPECT_FALSE(Health{}.is_usable());
  constexpr std::array kDoubts = {
      &Health::sample_refused,        &Health::time_refused,          &Health::saturated,
      &Health::model_inconsistent,    &Health::sensor_fault,          &Health::measurement_rejected,
      &Health::odometer_disagreement, &Health::reference_disagreement};
  constexpr std::array kHarmless = {&Health::odometer_fault, &Health::temperature_missing,
                                    &Health::acceleration_missing, &Health::odometer_dead_band,
                                    &Health::sample_rate_off};
  // `calibrated` is the one flag of neither list.
  static_assert(sizeof(Health) == kDoubts.size() + kHarmless.size() + 1);
  Health all{.calibrated = true};
  EXPECT_TRUE(all.is_usable());
  for (const auto flag : kHarmless) all.*flag = true;
  EXPECT_TRUE(all.is_usable());
  for (const auto flag : kDoubts) {
    Health health{.calibrated = true};
    health.*flag = true;
    EXPECT_FALSE(health.is_usable());
    health.calibrated = false;
    EXPECT_FALSE(health.is_usable());
  }
}

}  // namespace
}  // namespace zerorate::app

#include "core/monitor/innovation_monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace zerorate::core {
namespace {

/// Feeds n innovations whose true standard deviation is `scale` times the predicted one.
InnovationMonitor after(int n, float scale) {
  InnovationMonitor monitor;
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  for (int k = 0; k < n; ++k) {
    monitor.observe({.accepted = true,
                     .residual_rad_s = 0.01F * scale * normal(random),
                     .variance_rad2_s2 = 1e-4F});
  }
  return monitor;
}

TEST(InnovationMonitor, TrustsAModelThatIsRight) {
  EXPECT_TRUE(after(20'000, 1.0F).is_consistent());
}

TEST(InnovationMonitor, NoticesASensorThatIsLouderOrQuieterThanItsModel) {
  EXPECT_FALSE(after(2'000, 1.4F).is_consistent());
  EXPECT_FALSE(after(2'000, 0.6F).is_consistent());
}

TEST(InnovationMonitor, SaysNothingFromTooFewInnovations) {
  EXPECT_TRUE(after(100, 3.0F).is_consistent());
}

TEST(InnovationMonitorGivenRefusedOrFirstMeasurements, CountsNothing) {
  InnovationMonitor monitor;
  monitor.observe({.accepted = false, .residual_rad_s = 9.0F, .variance_rad2_s2 = 1.0F});
  monitor.observe(
      {.accepted = true, .first = true, .residual_rad_s = 9.0F, .variance_rad2_s2 = 1.0F});
  EXPECT_EQ(monitor.state().count, 0U);
}

static_assert(InnovationMonitor::kTolerance * InnovationMonitor::kTolerance * 511 > 49.9F &&
                  InnovationMonitor::kTolerance * InnovationMonitor::kTolerance * 511 < 50.2F,
              "five standard deviations: 25 * 2 / 511");

}  // namespace
}  // namespace zerorate::core

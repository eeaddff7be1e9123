#include "core/monitor/innovation_monitor.hpp"

#include <gtest/gtest.h>

#include <boost/math/distributions/chi_squared.hpp>
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

/// Feeds n innovations of the same NIS.
InnovationMonitor after_constant(int n, float normalised_squared) {
  InnovationMonitor monitor;
  for (int k = 0; k < n; ++k) {
    monitor.observe({.accepted = true,
                     .residual_rad_s = std::sqrt(normalised_squared),
                     .variance_rad2_s2 = 1.0F});
  }
  return monitor;
}

TEST(InnovationMonitor, TrustsAModelThatIsRight) {
  EXPECT_TRUE(after(20'000, 1.0F).is_consistent());
}

/// Verifies SR-HEALTH-04.
TEST(InnovationMonitor, NoticesALouderOrQuieterSensor) {
  EXPECT_FALSE(after(2'000, 1.4F).is_consistent());
  EXPECT_FALSE(after(2'000, 0.6F).is_consistent());
}

/// Boost's chi-squared quantile at five standard deviations of a normal, either side.
/// Verifies SR-HEALTH-04.
TEST(InnovationMonitorOfFewInnovations, JudgesByChiSquared) {
  const double tail = 2.866515719e-7;
  for (const int n : {1, 2, 4, 16, 64, 256}) {
    const boost::math::chi_squared chi_squared(n);
    const double highest = quantile(complement(chi_squared, tail)) / n;
    const double lowest = quantile(chi_squared, tail) / n;
    const auto constant = [n](double normalised_squared) {
      return after_constant(n, static_cast<float>(normalised_squared)).is_consistent();
    };
    // Wilson and Hilferty's approximation is generous in the far tail of one or two.
    EXPECT_TRUE(constant(0.93 * highest)) << n;
    EXPECT_FALSE(constant((n < 4 ? 1.3 : 1.07) * highest)) << n;
    if (n < 64) continue;  // fewer are never too quiet
    EXPECT_TRUE(constant(1.07 * lowest)) << n;
    EXPECT_FALSE(constant(0.93 * lowest)) << n;
  }
}

TEST(InnovationMonitorAfterAKnock, SpeaksAtOnceAndForgetsIt) {
  InnovationMonitor monitor = after(1000, 1.0F);
  monitor.observe({.accepted = true, .residual_rad_s = 10.0F, .variance_rad2_s2 = 1e-4F});
  EXPECT_FALSE(monitor.is_consistent());
  for (int k = 0; k < InnovationMonitor::kMemory; ++k) {
    monitor.observe({.accepted = true, .residual_rad_s = 0.01F, .variance_rad2_s2 = 1e-4F});
  }
  EXPECT_TRUE(monitor.is_consistent());
}

// Learnt errors stay as long in seconds, however quickly the filter forgets its innovations.
/// Verifies SR-HEALTH-04.
TEST(InnovationMonitorOfAFastFilter, ReportsForTwoMinutes) {
  for (const int filter_hz : {2, 10, 50, 100}) {
    InnovationMonitor monitor{Duration::milliseconds(1000 / filter_hz)};
    const auto observe = [&](float normalised_squared) {
      monitor.observe({.accepted = true,
                       .residual_rad_s = std::sqrt(normalised_squared),
                       .variance_rad2_s2 = 1.0F});
    };
    for (int k = 0; k < 1000; ++k) observe(1.0F);
    for (int k = 0; k < 256; ++k) observe(3.0F);
    EXPECT_FALSE(monitor.is_consistent()) << filter_hz;
    int plausible = 0;
    while (!monitor.is_consistent() && plausible < 100'000) {
      observe(1.0F);
      ++plausible;
    }
    const double doubted_s = static_cast<double>(plausible) / filter_hz;
    EXPECT_GT(doubted_s, 60.0) << filter_hz;
    EXPECT_LT(doubted_s, 260.0) << filter_hz;
  }
}

TEST(InnovationMonitorGivenRefusedOrFirstMeasurements, CountsNone) {
  InnovationMonitor monitor;
  monitor.observe({.accepted = false, .residual_rad_s = 9.0F, .variance_rad2_s2 = 1.0F});
  monitor.observe(
      {.accepted = true, .first = true, .residual_rad_s = 9.0F, .variance_rad2_s2 = 1.0F});
  EXPECT_EQ(monitor.state().count, 0U);
}

}  // namespace
}  // namespace zerorate::core

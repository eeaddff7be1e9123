#include "host_tools/lib/fleet/quality.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tests/unit/host_tools/fleet/made_fleet.hpp"
#include "host_tools/lib/fleet/population.hpp"

namespace zerorate::fleet {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Values of two lots with known means and one spread.
struct MadeValues {
  std::vector<double> values;
  std::vector<std::size_t> lots;

  MadeValues(std::size_t sensors, double step_of_lot, std::uint64_t seed) {
    const random::RandomStream noise{seed};
    for (std::size_t i = 0; i < sensors; ++i) {
      lots.push_back(i % 2);
      values.push_back(noise.normal(static_cast<std::int64_t>(i)) +
                       (lots.back() == 1 ? step_of_lot : 0.0));
    }
  }
};

TEST(Capability, IsTheDistanceOfTheNearerLimit) {
  const std::vector<double> values{1.0, 2.0, 3.0, 2.0};
  const std::vector<std::size_t> lots{0, 0, 0, 0};
  const auto found = capability_of(values, lots, values.size(), {0.0, 6.0});
  ASSERT_TRUE(found.has_value());
  EXPECT_DOUBLE_EQ(found->mean, 2.0);
  EXPECT_DOUBLE_EQ(found->spread, std::sqrt(2.0 / 3.0));
  EXPECT_DOUBLE_EQ(found->ppk.value, 2.0 / (3.0 * found->spread));
  EXPECT_FALSE(found->cpk.has_value());
}

TEST(Capability, OfOneLimitIsThatOfTheOther) {
  const MadeValues made{50, 0.0, 1};
  const auto both = capability_of(made.values, made.lots, 50, {-kInfinite, 3.0});
  ASSERT_TRUE(both.has_value());
  EXPECT_DOUBLE_EQ(both->ppk.value, (3.0 - both->mean) / (3.0 * both->spread));
  EXPECT_FALSE(capability_of(made.values, made.lots, 50, {-kInfinite, kInfinite}).has_value());
}

TEST(Capability, CountsValuesOnEitherSide) {
  const std::vector<double> values{-2.0, 0.0, 0.5, 3.0, 4.0};
  const std::vector<std::size_t> lots{0, 0, 0, 1, 1};
  const auto found = capability_of(values, lots, values.size(), {-1.0, 2.0});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->below, 1U);
  EXPECT_EQ(found->above, 2U);
}

TEST(Capability, WithinLotsLeavesTheirDifferenceOut) {
  // Two lots 4 apart: the spread of all is sqrt(1 + 2^2), that within them 1.
  const MadeValues made{2000, 4.0, 2};
  const auto found = capability_of(made.values, made.lots, 2000, {-8.0, 12.0});
  ASSERT_TRUE(found && found->cpk && found->lot_spread);
  // A standard deviation of n values errs by 1 / sqrt(2 n): four of these.
  const double error = 4.0 / std::sqrt(2.0 * 2000.0);
  EXPECT_NEAR(*found->lot_spread, 1.0, error);
  EXPECT_NEAR(found->spread, std::sqrt(5.0), std::sqrt(5.0) * error);
  EXPECT_NEAR(found->cpk->value / found->ppk.value, found->spread / *found->lot_spread, 1e-12);
}

TEST(Capability, IntervalHoldsTheTruthAsOftenAsItSays) {
  constexpr int kFleets = 1000;
  constexpr double kTrue = 4.0 / 3.0;  // a spread of 1 and limits 4 from the mean
  int inside = 0;
  for (int k = 0; k < kFleets; ++k) {
    const MadeValues made{60, 0.0, 100 + static_cast<std::uint64_t>(k)};
    const auto found = capability_of(made.values, made.lots, 60, {-kInfinite, 4.0});
    ASSERT_TRUE(found.has_value());
    if (found->ppk.lo <= kTrue && kTrue <= found->ppk.hi) ++inside;
  }
  // 0.95 with four standard errors of a share of 1000.
  EXPECT_NEAR(inside, 0.95 * kFleets, 4.0 * std::sqrt(0.95 * 0.05 * kFleets));
}

TEST(Share, OfNoneAndAllHasAnInterval) {
  EXPECT_EQ(share_of(0, 20).lo, 0.0);
  EXPECT_GT(share_of(0, 20).hi, 0.1);
  EXPECT_LT(share_of(20, 20).lo, 0.9);
  EXPECT_NEAR(share_of(20, 20).hi, 1.0, 1e-12);
  EXPECT_EQ(share_of(0, 0).hi, 1.0);
}

TEST(ControlChart, NamesTheValueThatLeavesIt) {
  std::vector<double> values;
  const random::RandomStream noise{5};
  for (std::int64_t i = 0; i < 40; ++i) values.push_back(noise.normal(i));
  values[17] = 9.0;
  const ControlChart chart = control_chart_of(values);
  EXPECT_THAT(chart.outside, ::testing::ElementsAre(17));
}

TEST(ControlChart, OfAShiftOfTheSecondHalfNamesIt) {
  std::vector<double> values;
  const random::RandomStream noise{6};
  for (std::int64_t i = 0; i < 40; ++i) values.push_back(noise.normal(i) + (i < 20 ? 0.0 : 20.0));
  // The one large step hardly widens the mean of 39 steps.
  EXPECT_GT(control_chart_of(values).outside.size(), 30U);
}

TEST(Quality, OfAFleetWithABadLotFailsThatLot) {
  const testing::ScratchFolder folder;
  const MadeFleet fleet{
      .sensors = 40, .lots = 4, .bad_lots = {2}, .bad_lot_shift = 2.0, .one_jumps = false};
  const Population population =
      fit_population(made_fleet(folder.path() / "fleet.sqlite", fleet), {});
  // Five spreads to either side of the good lots, of which the shift is thirteen.
  Limits limits;
  limits.angle_random_walk_rad_per_sqrt_s = Range{std::exp(kLogWhite - 5.0 * kLogWhiteSpread),
                                                  std::exp(kLogWhite + 5.0 * kLogWhiteSpread)};
  const Quality quality = quality_of(population, &limits);
  EXPECT_EQ(quality.passed, 30U);
  EXPECT_EQ(quality.failed, 10U);
  EXPECT_DOUBLE_EQ(quality.yield.value, 0.75);
  EXPECT_EQ(quality.order.size(), 40U);
  ASSERT_TRUE(quality.figures.front().capability && quality.figures.front().capability->cpk);
  EXPECT_LT(quality.figures.front().capability->ppk.value,
            quality.figures.front().capability->cpk->value);
  EXPECT_FALSE(quality.figures[1].capability.has_value());
}

TEST(Quality, LimitsAreDrawnInTheChartsOfTheirFigure) {
  Population population =
      fit_population(made_fleet(":memory:", {.sensors = 12, .lots = 2, .one_jumps = false}), {});
  Limits limits;
  limits.angle_random_walk_rad_per_sqrt_s = Range{0.0, std::exp(kLogWhite + 3.0 * kLogWhiteSpread)};
  population.quality = quality_of(population, &limits);
  const std::string html = make_report(population, "test").html();
  // exp(-9 + 0.45) in degrees
  const std::string named = "Upper limit of an axis: 0.01109 deg/s/sqrt(Hz).";
  const auto first = html.find(named);
  ASSERT_NE(first, std::string::npos);
  EXPECT_NE(html.find(named, first + 1), std::string::npos);
  EXPECT_THAT(html, ::testing::HasSubstr("Inside of the limits"));
  EXPECT_THAT(html, ::testing::HasSubstr("\"Upper limit\""));
  EXPECT_THAT(html, ::testing::Not(::testing::HasSubstr("Lower limit")));
}

TEST(Quality, ChartsCountLotsAndSensorsByTheirNumbers) {
  const Population population =
      fit_population(made_fleet(":memory:", {.sensors = 48, .lots = 12, .one_jumps = false}), {});
  const Quality quality = quality_of(population, nullptr);
  for (std::size_t place = 0; place < quality.order.size(); ++place) {
    EXPECT_EQ(population.sensors[quality.order[place]].name, std::to_string(place));
  }
}

TEST(ComesBefore, OrdersNamesByTheNumbersInThem) {
  const std::vector<std::string> in_order{"",      "2026-9-30", "2026-11-02", "L1", "L2", "L2-9",
                                          "L2-10", "L10",       "L010a",      "La", "M1"};
  for (std::size_t i = 0; i < in_order.size(); ++i) {
    for (std::size_t k = 0; k < in_order.size(); ++k) {
      EXPECT_EQ(comes_before(in_order[i], in_order[k]), i < k) << in_order[i] << " " << in_order[k];
    }
  }
  EXPECT_TRUE(comes_before("L01", "L1"));  // another name of the same number
  EXPECT_FALSE(comes_before("L1", "L01"));
}

TEST(Quality, WithoutLimitsHasChartsAlone) {
  const testing::ScratchFolder folder;
  const Population population = fit_population(
      made_fleet(folder.path() / "fleet.sqlite", {.sensors = 12, .lots = 2, .one_jumps = false}),
      {});
  const Quality quality = quality_of(population, nullptr);
  EXPECT_FALSE(quality.has_limits);
  EXPECT_EQ(quality.figures.front().values.size(), 12U);
}

}  // namespace
}  // namespace zerorate::fleet

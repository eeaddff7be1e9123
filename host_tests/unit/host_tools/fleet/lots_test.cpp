// Fleets of a few lots, up to half of them bad: which are named, and how large the difference is.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "host_tests/unit/host_tools/fleet/made_fleet.hpp"
#include "host_tools/lib/fleet/lots.hpp"
#include "host_tools/lib/fleet/population.hpp"

namespace zerorate::fleet {
namespace {

constexpr std::size_t kSensorsOfLot = 10;
/// Noise of a bad lot: 1.5 times N and B.
const double kBadShift = std::log(1.5);

struct LotCount {
  int bad = 0;
  int bad_named = 0;
  int good = 0;
  int good_named = 0;
  int sizes = 0;
  int sizes_inside = 0;       ///< planted size inside of the 95 % interval
  double sum_of_white = 0.0;  ///< sizes of ln N

  void add(const Population& population, const std::set<std::size_t>& bad_lots) {
    for (const Lot& lot : population.lots) {
      const bool is_bad = bad_lots.contains(std::stoul(lot.name.substr(1)));
      ++(is_bad ? bad : good);
      if (lot.differs) ++(is_bad ? bad_named : good_named);
    }
    for (const LotFigure& figure : population.lot_figures) {
      if (figure.what != "angle_random_walk" && figure.what != "bias_instability") continue;
      const std::string& name = population.lots[figure.lot].name;
      if (!bad_lots.contains(std::stoul(name.substr(1)))) continue;
      ++sizes;
      if (!figure.effect) continue;
      if (figure.what == "angle_random_walk") sum_of_white += figure.effect->value;
      if (figure.effect->lo <= kBadShift && kBadShift <= figure.effect->hi) ++sizes_inside;
    }
  }

  LotCount& operator+=(const LotCount& other) {
    bad += other.bad;
    bad_named += other.bad_named;
    good += other.good;
    good_named += other.good_named;
    sizes += other.sizes;
    sizes_inside += other.sizes_inside;
    sum_of_white += other.sum_of_white;
    return *this;
  }
};

/// Every `step`th lot of so many is bad.
std::set<std::size_t> bad_of(std::size_t lots, std::size_t step) {
  std::set<std::size_t> bad;
  for (std::size_t i = 0; i < lots / step; ++i) bad.insert(i * step);
  return bad;
}

Population made_population(std::size_t lots, const std::set<std::size_t>& bad, double shift,
                           std::uint64_t seed) {
  return fit_population(made_fleet(":memory:", {.sensors = lots * kSensorsOfLot,
                                                .lots = lots,
                                                .bad_lots = bad,
                                                .bad_lot_shift = shift,
                                                .common_share = 0.5,
                                                .one_jumps = false,
                                                .seed = seed}),
                        {});
}

/// A row of the table in docs/reference/fleets.md.
void print(const std::string& what, const LotCount& count) {
  std::printf("| %s | %d of %d | %d of %d | %d of %d |", what.c_str(), count.bad_named, count.bad,
              count.good_named, count.good, count.sizes_inside, count.sizes);
  if (count.bad > 0) std::printf(" %.3f", count.sum_of_white / count.bad / kBadShift);
  std::printf(" |\n");
}

/// Tolerance: three binomial standard deviations of each share, lots of one fleet being
/// independent.
void expect_named_and_sized(const LotCount& count, const std::string& what) {
  const auto least = [](double share, int of) {
    return share * of - 3.0 * std::sqrt(share * (1.0 - share) * of);
  };
  EXPECT_GE(count.bad_named, least(0.95, count.bad)) << what << ", of " << count.bad;
  EXPECT_LE(count.good_named, count.good - least(0.95, count.good))
      << what << ", of " << count.good;
  EXPECT_GE(count.sizes_inside, least(0.90, count.sizes)) << what << ", of " << count.sizes;
}

/// Fleets of these sizes with a sixth, a third and a half of bad lots, each with so many seeds.
/// @return the sum of all rows, each of which keeps what is promised
LotCount count_fleets(const std::vector<std::size_t>& sizes, std::uint64_t seeds) {
  LotCount all;
  for (const std::size_t lots : sizes) {
    for (const std::size_t step : {6U, 3U, 2U}) {
      const std::set<std::size_t> bad = bad_of(lots, step);
      LotCount row;
      for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        row.add(made_population(lots, bad, kBadShift, 1000 * lots + 100 * step + seed), bad);
      }
      const std::string what = std::to_string(lots) + " | " + std::to_string(bad.size());
      expect_named_and_sized(row, what);
      print(what, row);
      all += row;
    }
  }
  return all;
}

void expect_fleets_are_judged(const std::vector<std::size_t>& sizes, std::uint64_t seeds) {
  const LotCount all = count_fleets(sizes, seeds);
  print("all |", all);
  expect_named_and_sized(all, "all");
  // Estimates drawn towards the population show in the mean of many. That of ln N of one lot beside
  // one other has an error of 0.14 of the size, that of 36 lots 0.03.
  EXPECT_NEAR(all.sum_of_white / all.bad / kBadShift, 1.0, 0.08);
}

TEST(LotStatistics, FewLotsOfWhichHalfAreBad) {
  expect_fleets_are_judged({2, 3, 6}, 4);
}

// Twenty seeds of each, in ./test --slow.
TEST(LotCampaign, UpToThirtyLotsOfWhichHalfAreBad) {
  expect_fleets_are_judged({2, 3, 6, 15, 20, 30}, 20);
}

TEST(LotStatistics, TwoLotsDifferAndTheQuieterIsTheReference) {
  const Population population = made_population(2, {0}, kBadShift, 5);
  const auto lot = [&](const std::string& name) {
    return *std::ranges::find(population.lots, name, &Lot::name);
  };
  EXPECT_TRUE(lot("L0").differs);
  EXPECT_FALSE(lot("L0").is_reference);
  EXPECT_TRUE(lot("L1").is_reference);
  EXPECT_TRUE(population.warnings.empty());
  EXPECT_THAT(to_text(population), ::testing::HasSubstr("lot L0: angle_random_walk is"));
  EXPECT_THAT(to_json(population), ::testing::HasSubstr("\"effect_ci95\""));
  EXPECT_THAT(make_report(population, "test").html(), ::testing::HasSubstr(" times"));
}

TEST(LotStatistics, LotsThatAllDifferAreComparedWithAWarning) {
  // Each lot another noise, 1.5 times that of the one before: lots of 4 times a lot's error apart.
  Database database{":memory:", Database::Access::write};
  const Population population = [&] {
    for (std::size_t lot = 0; lot < 5; ++lot) {
      const Database one =
          made_fleet(":memory:", {.sensors = kSensorsOfLot,
                                  .lots = 1,
                                  .bad_lots = {0},
                                  .bad_lot_shift = kBadShift * static_cast<double>(lot),
                                  .one_jumps = false,
                                  .seed = lot});
      one.for_each([&](StoredRecording recording) {
        recording.hash += "-" + std::to_string(lot);
        recording.entry.lot = "L" + std::to_string(lot);
        recording.entry.sensor += "-" + std::to_string(lot);
        database.store(recording);
      });
    }
    return fit_population(database, {});
  }();
  ASSERT_EQ(population.warnings.size(), 1U);
  EXPECT_THAT(population.warnings.front(), ::testing::HasSubstr("no half of the lots agrees"));
  EXPECT_EQ(std::ranges::count(population.lots, true, &Lot::is_reference), 3);
}

TEST(LotStatistics, FleetOfRareEffectsIsReportedWithAWarning) {
  Database database{":memory:", Database::Access::write};
  made_fleet(":memory:", {.sensors = 10, .lots = 1, .one_jumps = false})
      .for_each([&](StoredRecording recording) {
        for (AxisResult& axis : recording.result.axes) axis.verdict = "unexplained";
        database.store(recording);
      });
  const Population population = fit_population(database, {});
  EXPECT_EQ(population.core, 30U);
  EXPECT_THAT(to_text(population), ::testing::HasSubstr("warning: fewer than 8 axes"));
  EXPECT_TRUE(type_model(population, "type").prior.has_value());
}

}  // namespace
}  // namespace zerorate::fleet

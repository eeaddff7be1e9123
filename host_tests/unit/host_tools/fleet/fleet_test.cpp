// Population, outliers, lots, prior and limits of fleets whose likelihoods are made by hand; lists,
// databases and their merging; one recording from end to end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "firmware/model/hypotheses.hpp"
#include "firmware/toml/error.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tests/unit/host_tools/fleet/made_fleet.hpp"
#include "host_tools/lib/fleet/database.hpp"
#include "host_tools/lib/fleet/population.hpp"
#include "host_tools/lib/fleet/simulated_fleet.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::fleet {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void write(const fs::path& path, const std::string& text) {
  std::ofstream{path} << text;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file{path, std::ios::binary};
  return {std::istreambuf_iterator<char>(file), {}};
}

class Fleet : public ::testing::Test {
 protected:
  testing::ScratchFolder folder_;
  [[nodiscard]] fs::path path(const std::string& name) const { return folder_.path() / name; }
};

/// Claims about populations: fleets of many sensors.
class FleetStatistics : public Fleet {};

/// Population of the fleet by its defaults, fitted once.
const Population& usual_population() {
  static const Population population = [] {
    const testing::ScratchFolder folder;
    return fit_population(made_fleet(folder.path() / "a.sqlite", {}), {});
  }();
  return population;
}

TEST(QValues, AreThoseOfBenjaminiAndHochberg) {
  const std::vector<double> q =
      q_values({std::log(0.01), std::log(0.04), std::log(0.02), std::log(0.9)});
  EXPECT_NEAR(q[0], 0.04, 1e-12);
  EXPECT_NEAR(q[2], 0.04, 1e-12);  // 0.02 * 4 / 2
  EXPECT_NEAR(q[1], 0.04 * 4.0 / 3.0, 1e-12);
  EXPECT_NEAR(q[3], 0.9, 1e-12);
  EXPECT_TRUE(q_values({}).empty());
}

TEST_F(FleetStatistics, IsThatOfSensorsNotOfTheirErrors) {
  const Population& population = usual_population();
  const double pivot = std::log(Grid::kPivot_rad_s);
  const double log_flicker = kLogWhite + kLogAmplitude + kOrder * pivot;
  const double log_flicker_spread =
      std::hypot(kLogWhiteSpread, kLogAmplitudeSpread, kOrderSpread * pivot);
  // Three standard errors: one seeded draw in 370 would miss each of them.
  EXPECT_NEAR(population.distribution.mean[0], kLogWhite, 3.0 * population.mean_error[0]);
  EXPECT_NEAR(population.distribution.mean[1], log_flicker, 3.0 * population.mean_error[1]);
  EXPECT_NEAR(population.distribution.mean[2], kOrder, 3.0 * population.mean_error[2]);
  // Recordings tell N within a tenth of its spread: its error is the spread / sqrt(1,200 axes).
  EXPECT_NEAR(population.mean_error[0], kLogWhiteSpread / std::sqrt(1200.0), 0.0006);
  // With n axes a spread is known to (1 + (error/spread)^2) / sqrt(2 n): 2 % for N, 4 % for d.
  EXPECT_NEAR(population.spread(0), kLogWhiteSpread, 0.1 * kLogWhiteSpread);
  EXPECT_NEAR(population.spread(1), log_flicker_spread, 0.1 * log_flicker_spread);
  EXPECT_NEAR(population.spread(2), kOrderSpread, 0.2 * kOrderSpread);
}

TEST_F(FleetStatistics, SpreadOfWhiteNoiseHoldsInShortRecords) {
  // 50 innovations tell ln N within 0.1: the estimates spread by hypot(0.15, 0.1) = 0.18.
  const Population population =
      fit_population(made_fleet(path("a.sqlite"), {.innovations = 50}), {});
  // Three standard errors: 3 (1 + (0.1 / 0.15)^2) / sqrt(2 * 1,200).
  EXPECT_NEAR(population.spread(0), kLogWhiteSpread, 0.09 * kLogWhiteSpread);
}

TEST_F(FleetStatistics, SensorWithARareEffectIsNamed) {
  const Population& population = usual_population();
  const auto found = std::ranges::find(population.sensors, "3", &Sensor::name);
  ASSERT_NE(found, population.sensors.end());
  EXPECT_TRUE(found->is_outlier);
  EXPECT_EQ(found->reasons.front().name, "bias_jump");
  EXPECT_EQ(found->reasons.front().axis, "y");
  // Among 399 others a false discovery rate of 5 % leaves hardly one.
  EXPECT_LE(std::ranges::count(population.sensors, true, &Sensor::is_outlier), 3);
  EXPECT_TRUE(std::ranges::none_of(population.lots, &Lot::differs));
  EXPECT_THAT(to_csv(population), HasSubstr("bias_jump"));
  EXPECT_THAT(to_json(population), HasSubstr("\"sensor\": \"3\""));
  EXPECT_THAT(make_report(population, "test").html(), HasSubstr("bias_jump"));
}

TEST_F(FleetStatistics, LotOfFourThatDiffersIsNamed) {
  const Population population = fit_population(
      made_fleet(path("a.sqlite"), {.lots = 100, .bad_lots = {4}, .bad_lot_shift = 0.4}),
      {.false_discovery_rate = 1e-3});  // one seed in a thousand names another
  for (const Lot& lot : population.lots) EXPECT_EQ(lot.differs, lot.name == "L4") << lot.name;
  EXPECT_EQ(population.lot_figures.front().what, "angle_random_walk");
  // The third of four means of three axes, 0.3 +- 0.6 of their standard deviations too high.
  EXPECT_NEAR(std::log(population.lot_figures.front().lot_value), kLogWhite + 0.4, 2.1 * 0.087);
  EXPECT_NEAR(population.distribution.mean[0], kLogWhite, 3.0 * population.mean_error[0]);
}

TEST_F(FleetStatistics, SensorThatChangesIsNamedAlone) {
  const Population population =
      fit_population(made_fleet(path("a.sqlite"),
                                {.sensors = 60, .recordings = 2, .lots = 1, .one_changes = true}),
                     {});
  for (const Sensor& sensor : population.sensors) {
    EXPECT_EQ(sensor.has_changed, sensor.name == "7") << sensor.name;
  }
}

TEST_F(FleetStatistics, PriorIsAsWideAsThePopulation) {
  const Population& population = usual_population();
  const model::SensorModel model = type_model(population, "type");
  EXPECT_NEAR(model.prior->order, kOrder, 0.02);
  EXPECT_NEAR(model.prior->order_sigma, kOrderSpread, 0.3 * kOrderSpread);
  EXPECT_NEAR(std::log(model.prior->amplitude_factor), kLogAmplitudeSpread,
              0.2 * kLogAmplitudeSpread);
  const auto hypotheses = model::hypotheses_of(model);
  ASSERT_EQ(hypotheses.size(), 12U);
  EXPECT_DOUBLE_EQ(hypotheses.front().flicker.order, model.prior->order - model.prior->order_sigma);
}

TEST_F(Fleet, FewSensorsLeaveThePriorWide) {
  const Population population =
      fit_population(made_fleet(path("a.sqlite"), {.sensors = 5, .lots = 1}), {});
  EXPECT_GT(type_model(population, "type").prior->amplitude_factor, 3.0);
}

TEST_F(FleetStatistics, LimitsOfAShortTestLeaveOutWhatItCannotTell) {
  const Population& population = usual_population();
  const Limits all = limits_of(population, 0.0);
  EXPECT_TRUE(all.bias_instability_rad_s);
  const Limits of_minute = limits_of(population, 60.0);
  EXPECT_TRUE(of_minute.angle_random_walk_rad_per_sqrt_s);
  EXPECT_FALSE(of_minute.bias_instability_rad_s);
  EXPECT_FALSE(of_minute.order);
  const Limits read = parse_limits(format_limits(all), "limits.toml");
  EXPECT_NEAR(read.bias_instability_rad_s->hi / all.bias_instability_rad_s->hi, 1.0, 1e-5);
  EXPECT_NEAR(read.order->lo, all.order->lo, 1e-5);
}

TEST_F(FleetStatistics, LimitsForALengthDecideNearlyEverySensor) {
  const Population& population = usual_population();
  const Limits limits = limits_of(population, 1000.0);
  ASSERT_TRUE(limits.angle_random_walk_rad_per_sqrt_s);
  ASSERT_TRUE(limits.bias_instability_rad_s);
  EXPECT_EQ(limits.bias_instability_rad_s->lo, 0.0);  // a quiet sensor is not bad
  std::set<std::size_t> undecided;
  for (const Member& member : population.members) {
    const auto is_inside = [&](std::size_t coordinate, const Range& range) {
      return range.lo <= std::exp(member.profiles[coordinate].lo) &&
             std::exp(member.profiles[coordinate].hi) <= range.hi;
    };
    if (!is_inside(0, *limits.angle_random_walk_rad_per_sqrt_s) ||
        !is_inside(1, *limits.bias_instability_rad_s)) {
      undecided.insert(member.sensor);
    }
  }
  EXPECT_LE(undecided.size(), 20U);  // one in twenty of 400
}

TEST(Limits, EffectsThatFailASensorAreKnown) {
  const Limits limits{.fail_on = {"bias_jump", "saturation"}};
  EXPECT_EQ(parse_limits(format_limits(limits), "limits.toml").fail_on, limits.fail_on);
  EXPECT_THAT(
      [] { (void)parse_limits("schema = \"zerorate.limits/1\"\nfail_on = [\"jump\"]\n", "l"); },
      ::testing::ThrowsMessage<toml_file::Error>(HasSubstr("bias_jump")));
}

TEST(Limits, MistakesAreNamedWithTheirLine) {
  const auto message = [](const char* text) -> std::string {
    try {
      static_cast<void>(parse_limits(text, "limits.toml"));
    } catch (const toml_file::Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message("schema = \"zerorate.limits/1\"\n[order]\nlo = 0.6\nhi = 0.4\n"),
              HasSubstr("limits.toml:4"));
  EXPECT_THAT(message("schema = \"zerorate.limits/1\"\n[ordr]\nlo = 0.4\nhi = 0.6\n"),
              HasSubstr("ordr"));
  EXPECT_THAT(message("schema = \"zerorate.model/1\"\n"), HasSubstr("zerorate.limits/1"));
}

TEST_F(Fleet, ListNamesRecordingsSensorsAndLots) {
  write(path("list.csv"), "# made by hand\nlot,recording,sensor\nA,b.csv,S2\nB,a.csv.gz,\n");
  const std::vector<Entry> entries = list_recordings(path("list.csv"));
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].name, "a.csv.gz");
  EXPECT_EQ(entries[0].sensor, "a");
  EXPECT_EQ(entries[1].sensor, "S2");
  EXPECT_EQ(entries[1].lot, "A");
  EXPECT_EQ(entries[1].path, path("b.csv"));
  write(path("twice.txt"), "a.csv\na.csv\n");
  EXPECT_THAT([&] { (void)list_recordings(path("twice.txt")); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("twice.txt:2")));
  EXPECT_THROW((void)list_recordings(folder_.path() / "nothing"), std::exception);
}

TEST(Lots, AreFoldersOrMatchesWhereTheListHasNone) {
  const std::vector<Entry> made = {{.name = "K7/S1_a.csv"}, {.name = "in/K8/S2_b.csv", .lot = "X"}};
  std::vector<Entry> entries = made;
  set_lots(entries, "folder");
  EXPECT_EQ(entries[0].lot, "K7");
  EXPECT_EQ(entries[1].lot, "X");
  entries = made;
  set_lots(entries, "(S[0-9])_");
  EXPECT_EQ(entries[0].lot, "S1");
  entries = made;
  EXPECT_THAT([&] { set_lots(entries, "(L[0-9])_"); },
              ::testing::ThrowsMessage<std::invalid_argument>(HasSubstr("K7/S1_a.csv does not")));
  EXPECT_THAT([&] { set_lots(entries, "("); },
              ::testing::ThrowsMessage<std::invalid_argument>(HasSubstr("regular expression")));
  entries = {{.name = "a.csv"}};
  EXPECT_THROW(set_lots(entries, "folder"), std::invalid_argument);
}

TEST_F(Fleet, MergedShardsHaveTheBytesOfOneProcessInAnyOrderAndTwice) {
  simulate_fleet({.sensors = 3, .samples = 1500, .lots = 1}, path("fleet"), {});
  const std::vector<Entry> recordings = list_recordings(path("fleet"));
  write(path("fleet/bad.csv"), "t_s,gx_dps\nnonsense\n");
  std::vector<Entry> all = recordings;
  all.push_back({.path = path("fleet/bad.csv"), .name = "bad.csv", .sensor = "bad"});
  all.push_back({.path = path("fleet/absent.csv"), .name = "absent.csv", .sensor = "absent"});
  {
    Database one{path("one.sqlite"), Database::Access::write};
    const RunSummary summary = run(all, one, {});
    EXPECT_EQ(summary.analysed, 5U);
    EXPECT_EQ(summary.bad.size(), 2U);
    const RunSummary again = run(all, one, {.jobs = 2});
    EXPECT_EQ(again.found_done, 4U);
    EXPECT_EQ(again.analysed, 1U);  // unreadable recordings are tried again
  }
  for (std::size_t i = 0; i < 2; ++i) {
    Database shard{path("s" + std::to_string(i)), Database::Access::write};
    (void)run(all, shard, {.shard = {i, 2}});
  }
  merge({path("one.sqlite")}, path("a"));
  merge({path("s1"), path("s0")}, path("b"));
  merge({path("s0")}, path("c"));
  merge({path("s1"), path("s0"), path("a")}, path("c"));
  EXPECT_EQ(bytes_of(path("a")), bytes_of(path("b")));
  EXPECT_EQ(bytes_of(path("a")), bytes_of(path("c")));
  EXPECT_EQ((Database{path("a"), Database::Access::read}.dump()),
            (Database{path("one.sqlite"), Database::Access::read}.dump()));
}

TEST_F(Fleet, MergedNamesDoNotDependOnTheOrder) {
  const auto shard = [&](const std::string& file, const std::string& lot) {
    Database database{path(file), Database::Access::write};
    database.store({.hash = "h", .entry = {.name = "a.csv", .sensor = "S, 1", .lot = lot}});
  };
  shard("s0", "L1");
  shard("s1", "L2");
  merge({path("s0"), path("s1")}, path("a"));
  merge({path("s1"), path("s0")}, path("b"));
  EXPECT_EQ(bytes_of(path("a")), bytes_of(path("b")));
}

TEST_F(Fleet, TableQuotesNamesWithCommas) {
  Database database = made_fleet(path("a.sqlite"), {.sensors = 5, .lots = 1});
  database.rename("h0", {.name = "a,b.csv", .sensor = "said \"S\"", .lot = "L0"});
  EXPECT_THAT(to_csv(fit_population(database, {})),
              HasSubstr("\n\"a,b.csv\",\"said \"\"S\"\"\",L0,x,"));
}

TEST_F(FleetStatistics, WhiteNoiseIsThatOfTheSamples) {
  constexpr double kWhite_dps = 0.005;
  simulate_fleet({.sensors = 8,
                  .lots = 1,
                  .white_dps_per_sqrt_hz = {kWhite_dps, 0.0},
                  .flicker_dph = {18.0, 0.0},
                  .order = {0.55, 0.0},
                  .hidden_share = 0.0,
                  .bad_lot_factor = 1.0},
                 path("fleet"), {});
  double sum = 0.0;
  for (const Entry& entry : list_recordings(path("fleet"))) {
    for (const AxisResult& axis : noise_of(read_population_samples(recording::Input{entry.path}))) {
      const AxisLikelihood likelihood = likelihood_of(axis);
      const auto best = std::ranges::max_element(likelihood.points, {}, &GridPoint::log_likelihood);
      sum += double{best->position[0]} - std::log(kWhite_dps * units::kRadPerDeg);
    }
  }
  // 2,000 ticks tell ln N within 0.016 where nothing else is to be found, and here within 0.03.
  // That of tick means is too low by 0.04.
  EXPECT_NEAR(sum / 24.0, 0.0, 3.0 * 0.03 / std::sqrt(24.0));
}

TEST_F(Fleet, RecordingsReadOtherwiseNeedAnotherDatabase) {
  const StoredRecording recording{.hash = "h", .entry = {.name = "a.csv", .sensor = "a"}};
  for (const std::string name : {"a", "b"}) {
    Database database{path(name), Database::Access::write};
    database.require_format(name == "a" ? "--units rate=radps" : "");
    database.store(recording);
    database.require_format(name == "a" ? "--units rate=radps" : "");
    EXPECT_THAT([&] { database.require_format("--axis z"); },
                ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("--axis z")));
  }
  EXPECT_THROW(merge({path("a"), path("b")}, path("c")), std::runtime_error);
  merge({path("a")}, path("c"));
  EXPECT_NO_THROW(
      (Database{path("c"), Database::Access::write}.require_format("--units rate=radps")));
}

TEST_F(Fleet, WhatIsNoDatabaseIsRefusedAndStaysAsItIs) {
  write(path("notes.sqlite"), "not a database");
  EXPECT_THROW((Database{path("notes.sqlite"), Database::Access::write}), std::runtime_error);
  EXPECT_EQ(bytes_of(path("notes.sqlite")), "not a database");
}

TEST_F(Fleet, RecordingIsAcceptedByLimitsThatItKeepsOnly) {
  simulate_fleet({.sensors = 1,
                  .samples = 6000,
                  .rate_hz = 100.0,
                  .lots = 1,
                  .hidden_share = 0.0,
                  .bad_lot_factor = 1.0},
                 path("fleet"), {});
  const fs::path recording = path("fleet/S00001-1.csv.gz");
  constexpr double kWhite = 0.005 / 57.29577951308232;  // the median of the fleet
  const auto judgement = [&](double lo, double hi) {
    return accept(recording, {.angle_random_walk_rad_per_sqrt_s = Range{lo * kWhite, hi * kWhite}})
        .judgement;
  };
  EXPECT_EQ(judgement(0.4, 2.5), Judgement::pass);
  // A diagnosis of a sensor without an effect changes nothing.
  EXPECT_EQ(accept(recording, {.fail_on = {"bias_jump", "periodic_disturbance"}}).judgement,
            Judgement::pass);
  EXPECT_EQ(judgement(3.0, 5.0), Judgement::fail);
  EXPECT_EQ(accept(recording, {.shortest_s = 60.1}).judgement, Judgement::too_short);
  EXPECT_EQ(accept(recording, {.shortest_s = 60.0}).judgement, Judgement::pass);  // 59.99 s apart
  // A minute does not determine the order within a tenth.
  EXPECT_EQ(accept(recording, {.order = Range{0.5, 0.6}}).judgement, Judgement::too_short);
}

// Flicker noise of a high order resembles a random walk: of this sensor the diagnosis names one.
TEST_F(Fleet, RandomWalkThatAnotherOrderExplainsIsNotCounted) {
  simulate_fleet({.sensors = 4, .lots = 1, .seed = 21, .hidden_share = 0.0, .bad_lot_factor = 1.0},
                 path("fleet"), {});
  const RecordingResult result =
      analyse(read_population_samples(recording::Input{path("fleet/S00004-1.csv.gz")}));
  std::size_t walks = 0;
  for (const AxisResult& axis : result.axes) {
    for (const Cause& cause : axis.causes) {
      if (cause.effect != "rate_random_walk") continue;
      walks += 1;
      EXPECT_TRUE(cause.may_be_order) << axis.axis;
      EXPECT_GT(cause.p_value, 1e-3) << axis.axis;
    }
  }
  EXPECT_EQ(walks, 1U);
}

}  // namespace
}  // namespace zerorate::fleet

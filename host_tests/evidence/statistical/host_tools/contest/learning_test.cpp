#include "host_tools/lib/contest/learning.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <tuple>

#include "host_tests/support/folders.hpp"
#include "host_tests/support/made_recording.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::contest {
namespace {

namespace fs = std::filesystem;
using evaluate::testing::kRates;
using evaluate::testing::rows_at_rest;
using evaluate::testing::sensor_model;
using evaluate::testing::write_rows;
using ::testing::HasSubstr;
using zerorate::testing::ScratchFolder;

constexpr double kPeriod_s = 1.0;
constexpr std::size_t kSeeds = 2;

std::vector<fs::path> two_recordings(const ScratchFolder& folder, std::size_t rows = 3000) {
  return {write_rows(folder.path() / "one.csv", kRates, rows_at_rest(rows, kPeriod_s, 1)),
          write_rows(folder.path() / "two.csv", kRates, rows_at_rest(rows, kPeriod_s, 2))};
}

LearningOptions options_of(std::vector<DataSheetError> cases) {
  return {.model = sensor_model(),
          .cases = std::move(cases),
          .drives = {
              .schedules = {{.still_s = 60.0, .drive_s = 120.0}}, .seeds = kSeeds, .threads = 1}};
}

// Five standard errors of a binomial share; drives of one axis are not quite independent, so the
// sample is taken to be half as large. The learnt interval is meant to be cautious at first: as
// much again upwards.
TEST(LearningNode, StatesHonestIntervalsWhateverTheDataSheetSays) {
  const ScratchFolder folder;
  const LearningContest contest = run_learning_contest(
      two_recordings(folder, 8000), options_of({{}, {.white = 3.0}, {1.0, 0.25}, {0.1, 0.1}}), {});
  const double error = 5.0 * std::sqrt(0.95 * 0.05 / (0.5 * static_cast<double>(contest.drives)));
  for (const auto& one : contest.cases) {
    SCOPED_TRACE(::testing::Message() << one.error.white << " " << one.error.flicker);
    EXPECT_GT(one.learning.overall.coverage.value, 0.95 - error);
    EXPECT_LT(one.learning.overall.coverage.value, 0.95 + error);
    EXPECT_LT(one.learning.over_on_others.value, 1.05);
  }
  // A tenth of the noise is an interval of a tenth: erf(0.1 * 1.96 / sqrt 2) = 0.16 of the drives.
  EXPECT_LT(contest.cases.back().fixed.overall.coverage.value, 0.16 + error);
}

// The evidence of 100 s at standstill counts half: 100 s / ln 2 = 144 measurements, whose root mean
// square has the relative standard deviation 1 / sqrt(2 * 144) = 0.06; five of them are allowed.
TEST(LearningNode, EndsEachRunWithTheNoiseOfTheSensor) {
  const ScratchFolder folder;
  const LearningContest contest =
      run_learning_contest(two_recordings(folder), options_of({{3.0, 1.0}, {0.1, 0.1}}), {});
  constexpr double kN = evaluate::testing::kArwRadRtS * units::kDegPerRad;
  for (const auto& one : contest.cases) {
    std::set<std::tuple<std::size_t, std::size_t, std::uint64_t>> runs;
    for (const LearntRun& run : one.runs) {
      runs.insert({run.recording, run.axis, run.seed});
      const evaluate::LearntInterval& learnt = run.model.angle_random_walk_dps_per_sqrt_hz;
      EXPECT_NEAR(learnt.value / kN, 1.0, 0.3);
      EXPECT_LT(learnt.lo, learnt.value);
      EXPECT_GT(learnt.hi, learnt.value);
      EXPECT_GT(run.model.stops, 0.0);
    }
    EXPECT_EQ(runs.size(), 2 * 3 * kSeeds);
    EXPECT_EQ(one.runs.size(), runs.size());
  }
}

TEST(FirstDrivesOfRunsWithFewDrives, AreAllDrives) {
  const ScratchFolder folder;
  LearningOptions options = options_of({{}});
  const auto recordings = two_recordings(folder);
  const LearningContest many = run_learning_contest(recordings, options, {});
  EXPECT_NE(many.cases[0].learning.first_drives.drift_rms_deg,
            many.cases[0].learning.overall.drift_rms_deg);
  options.drives.schedules = {{.still_s = 800.0, .drive_s = 600.0}};
  const LearningContest few = run_learning_contest(recordings, options, {});
  ASSERT_LE(few.drives, LearningContest::kFirstDrives * 2 * 3 * kSeeds);
  EXPECT_EQ(few.cases[0].learning.first_drives.drift_rms_deg,
            few.cases[0].learning.overall.drift_rms_deg);
  EXPECT_EQ(few.cases[0].learning.first_drives.coverage.value,
            few.cases[0].learning.overall.coverage.value);
}

TEST(LearningContest, DoesNotDependOnThreadsOrOtherCases) {
  const ScratchFolder folder;
  const auto recordings = two_recordings(folder);
  LearningOptions options = options_of({{}, {.white = 3.0}});
  options.drives.seeds = 1;
  const LearningContest alone = run_learning_contest(recordings, options, {});
  options.drives.threads = 3;
  options.cases = {{.white = 3.0}};
  const LearningContest together = run_learning_contest(recordings, options, {});
  EXPECT_EQ(alone.tuned[0].overall.ratio.hi, together.tuned[0].overall.ratio.hi);
  EXPECT_EQ(alone.cases[1].learning.overall.ratio.value,
            together.cases[0].learning.overall.ratio.value);
  EXPECT_EQ(alone.cases[1].runs.back().model.order.value,
            together.cases[0].runs.back().model.order.value);
  EXPECT_NE(alone.cases[0].fixed.overall.ratio.value, alone.cases[1].fixed.overall.ratio.value);
}

// The other recordings' fit is what `evaluate drives` itself compares.
TEST(LearningContest, HasTheFittedFiltersOfTheContestOnDrives) {
  const ScratchFolder folder;
  const auto recordings = two_recordings(folder);
  LearningOptions options = options_of({{}});
  const LearningContest learning = run_learning_contest(recordings, options, {});
  const auto kalman = static_cast<std::size_t>(Contestant::kalman_extended);
  for (const auto& [tuned, fit_on] :
       {std::pair{Tuned::on_others, FitOn::other}, std::pair{Tuned::hindsight, FitOn::itself}}) {
    options.drives.fit_on = fit_on;
    const DriveStanding known = run_drive_contest(recordings, options.drives, {}).overall[kalman];
    const DriveStanding& own = learning.tuned[static_cast<std::size_t>(tuned)].overall;
    EXPECT_EQ(own.drift_rms_deg, known.drift_rms_deg);
    EXPECT_EQ(own.coverage.value, known.coverage.value);
  }
}

std::string message_of(const std::vector<fs::path>& recordings, const LearningOptions& options) {
  try {
    (void)run_learning_contest(recordings, options, {});
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

TEST(LearningContestThatCannotBe, SaysWhy) {
  const ScratchFolder folder;
  auto recordings = two_recordings(folder);
  for (const double factor : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(message_of(recordings, options_of({{.white = factor}})),
                HasSubstr("must be positive"));
    EXPECT_THAT(message_of(recordings, options_of({{.flicker = factor}})),
                HasSubstr("must be positive"));
  }
  LearningOptions options = options_of({{}});
  options.model.learning = model::Learning{.hypotheses = 1};
  EXPECT_THAT(message_of(recordings, options), HasSubstr("leaves nothing to learn"));
  options = options_of({{}});
  options.model.flicker.reset();
  EXPECT_THAT(message_of(recordings, options), HasSubstr("leaves nothing to learn"));
  options = options_of({{}});
  options.drives.schedules[0].still_s = 1e9;
  EXPECT_THAT(message_of(recordings, options), HasSubstr("too short"));
  recordings.pop_back();
  EXPECT_THAT(message_of(recordings, options_of({{}})), HasSubstr("at least two recordings"));
}

// Drifts of 2 and 3 over 1 and 4 rms: the geometric mean of 2 and 3/4.
TEST(StandingsOfTwoAxes, AreThoseByHand) {
  const DriveResults yardstick{{{.drives = 4, .squares_rad2 = 4.0, .covered = 4}},
                               {{.drives = 2, .squares_rad2 = 32.0, .covered = 1}}};
  const DriveResults own{{{.drives = 4, .squares_rad2 = 16.0, .covered = 3, .sigma_rad = 4.0}},
                         {{.drives = 2, .squares_rad2 = 18.0, .covered = 2, .sigma_rad = 2.0}}};
  const Standings standings{yardstick, 1};
  const DriveStanding standing = standings.standing(own, {0, 1});
  EXPECT_DOUBLE_EQ(standing.ratio.value, std::sqrt(1.5));
  EXPECT_DOUBLE_EQ(standing.ratio.lo, 0.75);
  EXPECT_DOUBLE_EQ(standing.ratio.hi, 2.0);
  EXPECT_DOUBLE_EQ(standing.coverage.value, 5.0 / 6.0);
  const double rms_rad = std::sqrt(34.0 / 6.0);
  EXPECT_DOUBLE_EQ(standing.drift_rms_deg, rms_rad * units::kDegPerRad);
  EXPECT_DOUBLE_EQ(standing.sigma_over_rms, 1.0 / rms_rad);
  EXPECT_EQ(standings.drives({0, 1}), 6.0);
  EXPECT_EQ(standings.ratio(own, own, {0, 1}).value, 1.0);
}

}  // namespace
}  // namespace zerorate::contest

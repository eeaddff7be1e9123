#include "host_tools/lib/contest/drives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "host_tests/support/folders.hpp"
#include "host_tests/support/made_recording.hpp"
#include "host_tools/lib/contest/exponential_means.hpp"

namespace zerorate::contest {
namespace {

namespace fs = std::filesystem;
using evaluate::testing::kRates;
using evaluate::testing::rows_at_rest;
using evaluate::testing::write_rows;
using zerorate::testing::ScratchFolder;

std::vector<fs::path> two_recordings(const ScratchFolder& folder) {
  return {write_rows(folder.path() / "one.csv", kRates, rows_at_rest(8000, 1.0, 1)),
          write_rows(folder.path() / "two.csv", kRates, rows_at_rest(8000, 1.0, 2))};
}

const DriveContestOptions kOptions{
    .schedules = {{.still_s = 60.0, .drive_s = 120.0}}, .seeds = 2, .threads = 1};

const BootstrapFigure& ratio(const DriveContest& contest, Contestant who) {
  return contest.overall[static_cast<std::size_t>(who)].ratio;
}

TEST(DriveContestOfSensorsWithFlickerNoise, RanksDecadesOverMean) {
  const ScratchFolder folder;
  const DriveContest contest = run_drive_contest(two_recordings(folder), kOptions, {});
  EXPECT_EQ(contest.fits.size(), 6U);
  EXPECT_GT(contest.drives, 400U);
  EXPECT_LT(ratio(contest, Contestant::kalman_base).hi, 1.0);
  EXPECT_LT(ratio(contest, Contestant::kalman_base).lo,
            ratio(contest, Contestant::kalman_base).value);
  EXPECT_LT(ratio(contest, Contestant::random_walk_filter).value, 1.0);
  EXPECT_LT(ratio(contest, Contestant::exponential_mean).value, 1.0);
  EXPECT_NEAR(ratio(contest, Contestant::moving_average).value, 1.0, 0.01);
  EXPECT_EQ(ratio(contest, Contestant::calibration_mean).value, 1.0);
}

// Five standard errors of a binomial share; drives of one axis are not quite independent, so the
// sample is taken to be half as large.
TEST(DriveContestOfSensorsThatAreAsTheirModel, HasHonestIntervals) {
  const ScratchFolder folder;
  const DriveContest contest = run_drive_contest(two_recordings(folder), kOptions, {});
  const double error = std::sqrt(0.95 * 0.05 / (0.5 * static_cast<double>(contest.drives)));
  for (const Contestant who :
       {Contestant::kalman_base, Contestant::moving_average, Contestant::calibration_mean}) {
    EXPECT_NEAR(contest.overall[static_cast<std::size_t>(who)].coverage.value, 0.95, 5.0 * error)
        << name(who);
  }
}

TEST(DriveContest, DoesNotDependOnTheNumberOfThreads) {
  const ScratchFolder folder;
  const auto recordings = two_recordings(folder);
  DriveContestOptions options = kOptions;
  options.seeds = 1;
  const DriveContest alone = run_drive_contest(recordings, options, {});
  options.threads = 3;
  const DriveContest together = run_drive_contest(recordings, options, {});
  for (std::size_t who = 0; who < kContestants; ++who) {
    EXPECT_EQ(alone.overall[who].ratio.value, together.overall[who].ratio.value);
    EXPECT_EQ(alone.overall[who].ratio.hi, together.overall[who].ratio.hi);
  }
}

std::string message_of(const std::vector<fs::path>& recordings,
                       const DriveContestOptions& options) {
  try {
    (void)run_drive_contest(recordings, options, {});
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

TEST(DriveContestThatCannotBe, SaysWhy) {
  const ScratchFolder folder;
  auto recordings = two_recordings(folder);
  DriveContestOptions options = kOptions;
  options.schedules[0].still_s = 1e9;
  EXPECT_THAT(message_of(recordings, options), ::testing::HasSubstr("too short"));
  recordings.pop_back();
  EXPECT_THAT(message_of(recordings, kOptions), ::testing::HasSubstr("at least two recordings"));
}

TEST(DriveContestOfASensorThatMoved, IsRefused) {
  const ScratchFolder folder;
  auto recordings = two_recordings(folder);
  auto rows = rows_at_rest(8000, 1.0, 3);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const bool drives = k / 400 % 2 == 1;
    rows[k].still = !drives;
    if (drives) rows[k].rate_rad_s[2] += 0.3F * std::sin(0.05F * static_cast<float>(k));
  }
  recordings[1] = write_rows(folder.path() / "moved.csv", kRates, rows);
  EXPECT_THAT(message_of(recordings, kOptions), ::testing::HasSubstr("moved.csv: the sensor was"));
  // An option that this command does not have.
  EXPECT_THAT(message_of(recordings, kOptions), ::testing::Not(::testing::HasSubstr("--still-")));
  recording::Columns columns = kRates;
  columns.still = true;
  recordings[1] = write_rows(folder.path() / "marked.csv", columns, rows);
  EXPECT_THAT(message_of(recordings, kOptions), ::testing::HasSubstr("by its odometer"));
}

TEST(DriveContestOfOneAxis, ScoresThatAxisAlone) {
  const ScratchFolder folder;
  const auto recordings = two_recordings(folder);
  DriveContestOptions options = kOptions;
  options.seeds = 1;
  const DriveContest all = run_drive_contest(recordings, options, {});
  options.axis = "z";
  const DriveContest one = run_drive_contest(recordings, options, {});
  ASSERT_EQ(one.fits.size(), 2U);
  EXPECT_EQ(one.fits[0].axis, 2U);
  EXPECT_EQ(3 * one.drives, all.drives);
}

// Samples of 1, 2, 3 at rest, then a drive at 10 for two seconds, by hand: the plain mean of three
// is 2; a memory of two samples weighs 1, 1/2, 1/2 and gives 2.25.
TEST(ExponentialMeansWithShortAndLongMemory, AreThoseByHand) {
  constexpr std::array kMemories_s = {2.0, 1e9};
  ExponentialMeans means{kMemories_s, 1};
  const auto observer = means.observer();
  app::RateMessage message;
  message.health.calibrated = true;
  std::uint64_t row = 0;
  for (const double rate : {1.0, 2.0, 3.0, 10.0, 10.0}) {
    message.time = core::Instant::from_ns(static_cast<std::int64_t>(row) * 1'000'000'000);
    message.axes[0].measured = core::rad_per_s(static_cast<float>(rate));
    observer({row, message.time.ns(), row >= 3, message, {}});
    ++row;
  }
  means.finish();
  EXPECT_DOUBLE_EQ(means.scores(0, 0).heading_drift_rms_rad(), 2.0 * (10.0 - 2.25));
  EXPECT_DOUBLE_EQ(means.scores(0, 1).heading_drift_rms_rad(), 2.0 * (10.0 - 2.0));
  EXPECT_EQ(means.scores(0, 1).drives(), 1U);
}

}  // namespace
}  // namespace zerorate::contest

#include "host_tools/lib/evaluate/odometer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tests/support/made_recording.hpp"

namespace zerorate::evaluate {
namespace {

using testing::kRates;
using testing::replay_file;
using testing::Replayed;
using testing::rows_at_rest;
using testing::sensor_model;
using testing::write_rows;
using zerorate::testing::ScratchFolder;

constexpr std::size_t kRows = 6000;
/// At 20 rows a second: a minute's stop, a minute's drive, and so on.
bool moves(std::size_t row) {
  return row / 1200 % 2 == 1;
}

TEST(ReplayWithAStillColumn, MovesWhereItSays) {
  const ScratchFolder folder;
  recording::Columns columns = kRates;
  columns.still = true;
  auto rows = rows_at_rest(kRows, 0.05, 1);
  for (std::size_t k = 0; k < kRows; ++k) rows[k].still = !moves(k);
  const Replayed replayed = replay_file(write_rows(folder.path() / "still.csv", columns, rows),
                                        {.model = sensor_model()});
  EXPECT_FALSE(replayed.result.truth_known);
  for (std::size_t k = 0; k < kRows; ++k) {
    ASSERT_EQ(replayed.moving[k] != 0, moves(k)) << k;
    if (moves(k)) {
      ASSERT_EQ(replayed.messages[k].motion, core::Motion::moving) << k;
    }
    // A stop's first second is settle time, the next half second hold-back.
    if (!moves(k) && k % 1200 > 40) {
      ASSERT_EQ(replayed.messages[k].motion, core::Motion::still) << k;
    }
  }
  EXPECT_EQ(replayed.result.scores[0][0].drives(), 2U);
}

TEST(ReplayWithAnOdometerColumn, MovesWhereItsCountChanges) {
  const ScratchFolder folder;
  recording::Columns columns = kRates;
  columns.odometer = true;
  auto rows = rows_at_rest(kRows, 0.05, 1);
  std::int64_t count = 123'456;  // a counter that was running before
  for (std::size_t k = 0; k < kRows; ++k) {
    if (moves(k)) count += 3;
    rows[k].odometer_pulses = count;
  }
  const Replayed replayed = replay_file(write_rows(folder.path() / "odometer.csv", columns, rows),
                                        {.model = sensor_model()});
  for (std::size_t k = 0; k < kRows; ++k) {
    if (moves(k)) {
      ASSERT_EQ(replayed.messages[k].motion, core::Motion::moving) << k;
    }
    if (!moves(k) && k % 1200 > 40) {
      ASSERT_EQ(replayed.messages[k].motion, core::Motion::still) << k;
    }
  }
  EXPECT_EQ(replayed.result.scores[0][0].drives(), 2U);
}

TEST(ReplayWithASchedule, PrefersItToTheColumnsAndKnowsTheTruth) {
  const ScratchFolder folder;
  recording::Columns columns = kRates;
  columns.still = true;
  auto rows = rows_at_rest(kRows, 0.05, 1);  // the column says: it moves all the time
  const Replayed replayed = replay_file(
      write_rows(folder.path() / "still.csv", columns, rows),
      {.model = sensor_model(), .schedule = ScheduleParams{.still_s = 20.0, .drive_s = 20.0}});
  EXPECT_TRUE(replayed.result.truth_known);
  EXPECT_TRUE(replayed.messages.back().health.calibrated);
}

TEST(PulsesOfAnOdometerColumn, AreOrderedAndLieBetweenTheRows) {
  recording::Columns columns;
  columns.odometer = true;
  const auto second = core::Duration::seconds(1);
  const auto odometer =
      make_odometer(columns, std::nullopt, core::Instant{}, core::Duration::milliseconds(50));
  std::vector<core::Instant> pulses;
  core::Instant at;
  recording::Row row;
  const auto next = [&](std::int64_t count) {
    pulses.clear();
    at = at + second;
    row.odometer_pulses = count;
    return odometer->pulses_until(at, row, pulses);
  };
  EXPECT_FALSE(next(1000));  // the count at the start says nothing
  EXPECT_TRUE(pulses.empty());
  EXPECT_TRUE(next(1004));
  ASSERT_EQ(pulses.size(), 4U);
  EXPECT_TRUE(std::is_sorted(pulses.begin(), pulses.end()));
  EXPECT_GT(pulses.front(), at - second);
  EXPECT_EQ(pulses.back(), at);
  EXPECT_TRUE(next(1'000'000));  // the newest one is what matters
  EXPECT_LE(pulses.size(), 16U);
  EXPECT_EQ(pulses.back(), at);
  EXPECT_TRUE(next(0));  // the counter was reset: it may have moved
  EXPECT_EQ(pulses.size(), 1U);
  EXPECT_FALSE(next(0));
  EXPECT_TRUE(pulses.empty());
}

}  // namespace
}  // namespace zerorate::evaluate

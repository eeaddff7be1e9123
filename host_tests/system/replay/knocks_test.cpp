// The gate through the node: knocks in a tenth of the stops, and a bias that really jumps.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tests/support/made_recording.hpp"
#include "host_tools/lib/evaluate/odometer.hpp"

namespace zerorate::evaluate {
namespace {

using testing::kRadPerDeg;
using testing::replay_file;
using testing::Replayed;
using testing::rows_at_rest;
using testing::sensor_model;
using testing::write_rows;
using zerorate::testing::ScratchFolder;

constexpr double kPeriod_s = 0.1;
constexpr recording::Columns kStill{3, recording::RateUnit::rad_per_s, false, false, true};

model::SensorModel gated_model() {
  model::SensorModel model = sensor_model();
  model.gate = model::Gate{.threshold_sigma = 5.0, .longest_knock_s = 5.0};
  return model;
}

/// The gate alone: to the check of the odometer a knock, and a jump too, is a turn without pulses,
/// and to the judge of the calm it is motion.
ReplayOptions of(const model::SensorModel& model) {
  return {.model = model,
          .standstill = {.source = core::StandstillSource::odometer_alone},
          .odometer = {.turn_rad_s = std::numeric_limits<float>::infinity()}};
}

/// The judge of the calm alone.
ReplayOptions calm_of(const model::SensorModel& model) {
  ReplayOptions options = of(model);
  options.standstill.source = core::StandstillSource::odometer;
  return options;
}

/// Stops of 60 s and drives of 300 s on the average.
std::vector<recording::Row> stops_and_drives(std::uint64_t seed) {
  auto rows = rows_at_rest(200'000, kPeriod_s, seed);
  Schedule schedule{{.still_s = 60.0, .drive_s = 300.0, .seed = seed}, core::Instant{}};
  for (auto& row : rows) row.still = !schedule.is_moving(core::Instant::from_ns(row.time_ns));
  return rows;
}

/// A door slams: 5 deg/s for a second, somewhere in every tenth stop.
void add_knocks(std::vector<recording::Row>& rows, std::uint64_t seed) {
  const random::RandomStream random{seed, 77};
  std::size_t begin = 0;
  for (std::int64_t stop = 0; begin < rows.size(); ++stop) {
    while (begin < rows.size() && !rows[begin].still) ++begin;
    std::size_t end = begin;
    while (end < rows.size() && rows[end].still) ++end;
    const std::size_t length = end - begin;
    if (stop % 10 == 5 && length > 40) {
      const auto place = static_cast<double>(length - 40) * random.uniform(stop);
      const std::size_t first = begin + 20 + static_cast<std::size_t>(place);
      for (std::size_t k = first; k < first + 10; ++k) {
        for (float& rate : rows[k].rate_rad_s) rate += static_cast<float>(5.0 * kRadPerDeg);
      }
    }
    begin = end;
  }
}

double drift(const Replayed& replayed, app::Predictor predictor) {
  double squares = 0.0;
  for (const auto& axis : replayed.result.scores) {
    squares += std::pow(axis[static_cast<std::size_t>(predictor)].heading_drift_rms_rad(), 2);
  }
  return std::sqrt(squares);
}

TEST(ReplayWithKnocksInATenthOfTheStops, KeepsItsRatioByGateOrCalm) {
  const ScratchFolder folder;
  double checked = 0.0;
  double gated = 0.0;
  double calmed = 0.0;
  double open = 0.0;
  double mean = 0.0;
  double untouched = 0.0;
  double covered = 0.0;
  constexpr int kSeeds = 4;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    auto rows = stops_and_drives(seed);
    const auto calm = write_rows(folder.path() / "calm.csv", kStill, rows);
    const Replayed before = replay_file(calm, of(gated_model()));
    add_knocks(rows, seed);
    const auto knocked = write_rows(folder.path() / "knocked.csv", kStill, rows);
    const Replayed with_gate = replay_file(knocked, of(gated_model()));
    const Replayed without = replay_file(knocked, of(sensor_model()));
    const Replayed with_calm = replay_file(knocked, calm_of(sensor_model()));
    const Replayed with_check = replay_file(knocked, {.model = gated_model()});
    EXPECT_GT(with_gate.result.samples_doubted, 0U);
    // Everything as a ratio to the plain mean of the last stop without knocks.
    const double yardstick = drift(before, app::Predictor::calibration_mean);
    checked += std::log(drift(with_check, app::Predictor::kalman) / yardstick) / kSeeds;
    gated += std::log(drift(with_gate, app::Predictor::kalman) / yardstick) / kSeeds;
    calmed += std::log(drift(with_calm, app::Predictor::kalman) / yardstick) / kSeeds;
    open += std::log(drift(without, app::Predictor::kalman) / yardstick) / kSeeds;
    mean += std::log(drift(without, app::Predictor::calibration_mean) / yardstick) / kSeeds;
    untouched += std::log(drift(before, app::Predictor::kalman) / yardstick) / kSeeds;
    for (const auto& axis : with_gate.result.scores) covered += axis[0].coverage95() / 12.0;
  }
  RecordProperty("gated_x1000", static_cast<int>(1000.0 * std::exp(gated)));
  RecordProperty("calmed_x1000", static_cast<int>(1000.0 * std::exp(calmed)));
  RecordProperty("ungated_x1000", static_cast<int>(1000.0 * std::exp(open)));
  RecordProperty("mean_x1000", static_cast<int>(1000.0 * std::exp(mean)));
  RecordProperty("without_knocks_x1000", static_cast<int>(1000.0 * std::exp(untouched)));
  RecordProperty("coverage_x1000", static_cast<int>(1000.0 * covered));
  EXPECT_LE(std::exp(checked), 0.80);
  EXPECT_LE(std::exp(gated), 0.80);
  EXPECT_LE(std::exp(calmed), 0.80);
  EXPECT_GE(std::exp(open), 1.2);
  EXPECT_GE(std::exp(mean), 2.5);
  EXPECT_NEAR(covered, 0.95, 0.04);
}

TEST(ReplayWhoseBiasJumps, ReacquiresItAfterTheLongestKnock) {
  const ScratchFolder folder;
  auto rows = rows_at_rest(3'000, kPeriod_s, 9);
  constexpr std::size_t kJump = 2'000;  // at 200 s
  constexpr double kSize = 0.5 * kRadPerDeg;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].still = true;
    if (k >= kJump) rows[k].rate_rad_s[2] += static_cast<float>(kSize);
  }
  const auto path = write_rows(folder.path() / "jump.csv", kStill, rows);
  const Replayed replayed = replay_file(path, of(gated_model()));
  const double truth = 0.1 * kRadPerDeg + kSize;
  const auto error = [&](std::size_t row) {
    return double{replayed.messages[row].axes[2].bias.in(core::rad_per_s)} - truth;
  };
  const auto sigma = [&](std::size_t row) {
    return double{replayed.messages[row].axes[2].sigma.in(core::rad_per_s)};
  };
  // The gate waits for 5 s, the hold-back and the tick take another second, and what is learnt
  // shows in the message a tick later.
  EXPECT_LT(error(kJump + 45), -0.9 * kSize);
  EXPECT_TRUE(replayed.messages[kJump + 45].health.measurement_rejected);
  EXPECT_GT(sigma(kJump + 55), 0.8 * kSize);  // the interval admits it by then
  std::size_t reacquired = kJump;
  while (std::abs(error(reacquired)) > 0.1 * kSize) ++reacquired;
  RecordProperty("reacquired_after_ms", static_cast<int>(100 * (reacquired - kJump)));
  EXPECT_LE(reacquired, kJump + 75);
  EXPECT_FALSE(replayed.messages[kJump + 80].health.measurement_rejected);
  // The judge of the calm doubts it for 5 s of its own before the gate does.
  const Replayed calm = replay_file(path, calm_of(gated_model()));
  const double late = double{calm.messages[kJump + 130].axes[2].bias.in(core::rad_per_s)} - truth;
  EXPECT_LT(std::abs(late), 0.1 * kSize);
}

// A jump this large could be a turn that the odometer does not know of: it must last two minutes.
TEST(ReplayWhoseBiasJumps, ReacquiresItAfterTheLongestTurn) {
  const ScratchFolder folder;
  constexpr std::size_t kJump = 2'000;  // at 200 s
  auto rows = rows_at_rest(4'000, kPeriod_s, 9);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].still = true;
    if (k >= kJump) rows[k].rate_rad_s[2] += static_cast<float>(0.5 * kRadPerDeg);
  }
  const auto path = write_rows(folder.path() / "jump.csv", kStill, rows);
  const Replayed replayed = replay_file(path, {.model = gated_model()});
  EXPECT_TRUE(replayed.messages[kJump + 15].health.odometer_disagreement);
  EXPECT_FALSE(replayed.messages[kJump + 1'230].health.odometer_disagreement);
  const auto& after = replayed.messages[kJump + 1'300];
  EXPECT_NEAR(double{after.axes[2].bias.in(core::rad_per_s)}, 0.6 * kRadPerDeg, 0.05 * kRadPerDeg);
}

}  // namespace
}  // namespace zerorate::evaluate

#include <gtest/gtest.h>

#include <cmath>
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

/// The phases of a schedule in plain code: exponential lengths, stops first.
std::vector<bool> moving_by_hand(const ScheduleParams& schedule, std::size_t rows,
                                 double period_s) {
  const random::RandomStream random{schedule.seed};
  std::vector<bool> moving(rows);
  double end_s = 0.0;
  bool moves = true;
  std::int64_t phase = 0;
  for (std::size_t k = 0; k < rows; ++k) {
    while (static_cast<double>(k) * period_s >= end_s) {
      moves = !moves;
      end_s += -(moves ? schedule.drive_s : schedule.still_s) * std::log(random.uniform(phase++));
    }
    moving[k] = moves;
  }
  return moving;
}

struct HandScores {
  std::size_t drives = 0;
  double drift_rms_rad = 0.0;
  double drift_mean_rad = 0.0;
  double rsse_rad_s = 0.0;
};

/// The calibration mean of one axis at one row a second, by hand. A row counts if it is neither the
/// very first (settle time) nor the last one of its stop (its tick is still open when the pulse
/// comes); the first row of a stop comes exactly the settle time after the newest pulse.
HandScores score_by_hand(const std::vector<recording::Row>& rows, const std::vector<bool>& moving,
                         std::size_t axis) {
  HandScores scores;
  std::vector<double> drifts;
  double mean = 0.0;
  bool calibrated = false;
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin;
    while (end < rows.size() && moving[end] == moving[begin]) ++end;
    if (!moving[begin]) {
      const std::size_t from = begin == 0 ? 1 : begin;
      double sum = 0.0;
      for (std::size_t k = from; k + 1 < end; ++k) sum += double{rows[k].rate_rad_s[axis]};
      if (from + 1 < end) {
        mean = sum / static_cast<double>(end - 1 - from);
        calibrated = true;
      }
    } else if (calibrated) {
      double drift = 0.0;
      double squares = 0.0;
      for (std::size_t k = begin; k < end; ++k) {
        const double error = double{rows[k].rate_rad_s[axis]} - mean;
        drift += error;
        squares += error * error;
      }
      drifts.push_back(drift);
      scores.rsse_rad_s += std::sqrt(squares);
    }
    begin = end;
  }
  scores.drives = drifts.size();
  for (const double drift : drifts) {
    scores.drift_mean_rad += drift;
    scores.drift_rms_rad += drift * drift;
  }
  const auto n = static_cast<double>(drifts.size());
  scores.drift_mean_rad /= n;
  scores.drift_rms_rad = std::sqrt(scores.drift_rms_rad / n);
  scores.rsse_rad_s /= n;
  return scores;
}

TEST(CalibrationMeanScores, EqualThoseByHand) {
  const ScratchFolder folder;
  const auto rows = rows_at_rest(4000, 1.0, 11);
  const auto path = write_rows(folder.path() / "rest.csv", kRates, rows);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const ScheduleParams schedule{.still_s = 15.0, .drive_s = 60.0, .seed = seed};
    const Replayed replayed = replay_file(path, {.model = sensor_model(), .schedule = schedule});
    EXPECT_EQ(replayed.result.samples_frozen, 0U);
    const std::vector<bool> moving = moving_by_hand(schedule, rows.size(), 1.0);
    EXPECT_EQ(std::vector<bool>(replayed.moving.begin(), replayed.moving.end()), moving);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const HandScores hand = score_by_hand(rows, moving, axis);
      const DriveScores& scores = replayed.result.scores[axis][2];
      EXPECT_EQ(scores.drives(), hand.drives);
      EXPECT_NEAR(scores.heading_drift_rms_rad() / hand.drift_rms_rad, 1.0, 1e-4);
      EXPECT_NEAR(scores.mean_integrated_rad(), hand.drift_mean_rad, 1e-4 * hand.drift_rms_rad);
      EXPECT_NEAR(scores.mean_rsse_rad_s() / hand.rsse_rad_s, 1.0, 1e-4);
    }
  }
}

TEST(ScoresOfDrives, AreTheMeansOfTheirOutcomes) {
  DriveScores scores;
  EXPECT_TRUE(std::isnan(scores.heading_drift_rms_rad()));
  EXPECT_TRUE(std::isnan(scores.coverage95()));
  scores.add({.drift_rad = 3.0, .sigma_rad = 1.0, .rsse_rad_s = 2.0});
  scores.add({.drift_rad = -4.0, .sigma_rad = 3.0, .rsse_rad_s = 4.0});
  EXPECT_EQ(scores.drives(), 2U);
  EXPECT_DOUBLE_EQ(scores.heading_drift_rms_rad(), std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(scores.mean_integrated_rad(), -0.5);
  EXPECT_DOUBLE_EQ(scores.mean_rsse_rad_s(), 3.0);
  EXPECT_DOUBLE_EQ(scores.coverage95(), 0.5);
  EXPECT_DOUBLE_EQ(scores.sigma_over_rms(), 2.0 / std::sqrt(12.5));
}

TEST(ScoresOfStops, AreTheMeansOfTheirErrors) {
  StopScores scores;
  EXPECT_TRUE(std::isnan(scores.error_rms_rad_s()));
  EXPECT_TRUE(std::isnan(scores.coverage95()));
  scores.add(3.0, 1.0, 5.0);
  scores.add(-4.0, 4.0, 2.0);
  EXPECT_EQ(scores.stops(), 2U);
  EXPECT_DOUBLE_EQ(scores.measured_s(), 3.5);
  EXPECT_DOUBLE_EQ(scores.error_rms_rad_s(), std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(scores.error_rms_sigmas(), std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(scores.coverage95(), 0.5);
}

/// Root mean square, over the stops after the first, of a stop's mean less that of the stop before:
/// what the calibration mean gets wrong. Rows count as in score_by_hand().
double change_between_stops(const std::vector<recording::Row>& rows,
                            const std::vector<bool>& moving, std::size_t axis) {
  std::vector<double> means;
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin;
    while (end < rows.size() && moving[end] == moving[begin]) ++end;
    const std::size_t from = begin == 0 ? 1 : begin;
    if (!moving[begin] && from + 1 < end && end < rows.size()) {
      double sum = 0.0;
      for (std::size_t k = from; k + 1 < end; ++k) sum += double{rows[k].rate_rad_s[axis]};
      means.push_back(sum / static_cast<double>(end - 1 - from));
    }
    begin = end;
  }
  double squares = 0.0;
  for (std::size_t i = 1; i < means.size(); ++i) {
    squares += (means[i] - means[i - 1]) * (means[i] - means[i - 1]);
  }
  return std::sqrt(squares / static_cast<double>(means.size() - 1));
}

TEST(StopScoresOfTheCalibrationMean, EqualThoseByHand) {
  const ScratchFolder folder;
  auto rows = rows_at_rest(4000, 1.0, 12);
  // Half a minute of rows shows that their steps are smaller than the noise.
  const ScheduleParams schedule{.still_s = 30.0, .drive_s = 60.0, .seed = 2};
  // The recording ends in a drive, so that every stop is whole.
  std::vector<bool> moving = moving_by_hand(schedule, rows.size(), 1.0);
  while (!moving.back()) moving.pop_back();
  rows.resize(moving.size());
  const auto path = write_rows(folder.path() / "rest.csv", kRates, rows);
  // A prediction sharper than any stop: each stop is then measured whole.
  model::SensorModel sharp = sensor_model();
  sharp.flicker->bias_instability_rad_s *= 1e-3;
  const Replayed replayed =
      replay_file(path, {.model = sharp, .schedule = schedule, .learns_noise = false});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const StopScores& scores = replayed.result.stop_scores[axis][2];
    EXPECT_GT(scores.stops(), 30U);
    EXPECT_NEAR(scores.error_rms_rad_s() / change_between_stops(rows, moving, axis), 1.0, 1e-3);
  }
}

/// Stops of 1000 s in which the bias rises by so much and falls back, and drives of 60 s without.
std::vector<recording::Row> rows_warming_at_stops(double rise_rad_s) {
  constexpr std::size_t kStop = 1000;
  constexpr std::size_t kDrive = 60;
  auto rows = rows_at_rest(10 * (kStop + kDrive), 1.0, 31);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::size_t place = k % (kStop + kDrive);
    rows[k].still = place < kStop;
    if (!rows[k].still) continue;
    const double share = static_cast<double>(place) / (0.5 * kStop);
    const auto rise = static_cast<float>(rise_rad_s * std::min(share, 2.0 - share));
    for (float& rate : rows[k].rate_rad_s) rate += rise;
  }
  return rows;
}

// The mean of each stop is that of the one before: compared with it, the calibration mean errs by
// nothing, and yet every drive by half of the rise.
TEST(StopScores, JudgeThePredictionByTheFirstSecondsOfAStop) {
  const ScratchFolder folder;
  recording::Columns columns = kRates;
  columns.still = true;
  const double rise = 0.1 * testing::kRadPerDeg;
  const auto path = write_rows(folder.path() / "warm.csv", columns, rows_warming_at_stops(rise));
  const Replayed replayed = replay_file(path, {.model = sensor_model(), .learns_noise = false});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const StopScores& scores = replayed.result.stop_scores[axis][2];
    EXPECT_EQ(scores.stops(), 9U);
    EXPECT_LT(scores.measured_s(), 100.0);
    EXPECT_NEAR(scores.error_rms_rad_s() / rise, 0.5, 0.15);
  }
}

// Simulated with the model that the node is given. Of n drives a share c is covered with a standard
// deviation of sqrt(c (1 - c) / n); the drives of one axis share a bias error, so that n counts for
// half. The lags follow the 1/f spectrum within 0.94 to 1.06, sigma within 3 %, coverage within
// 2 phi(1.96) 1.96 0.03 = 0.007.
// The stops are measured by the same filter, so that the same tolerance holds for them.
TEST(IntervalsUnderTheTrueModel, CoverDrivesAndStopsAt95Percent) {
  const ScratchFolder folder;
  const auto path = write_rows(folder.path() / "rest.csv", kRates, rows_at_rest(60'000, 1.0, 21));
  const Replayed replayed =
      replay_file(path, {.model = sensor_model(),
                         .schedule = ScheduleParams{.still_s = 30.0, .drive_s = 120.0, .seed = 5}});
  for (std::size_t p = 0; p < app::kPredictors; ++p) {
    double covered = 0.0;
    double drives = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const DriveScores& scores = replayed.result.scores[axis][p];
      covered += scores.coverage95() * static_cast<double>(scores.drives());
      drives += static_cast<double>(scores.drives());
    }
    EXPECT_GT(drives, 1000.0);
    const double tolerance = 4.0 * std::sqrt(0.95 * 0.05 / (0.5 * drives)) + 0.007;
    EXPECT_NEAR(covered / drives, 0.95, tolerance) << name(kAllPredictors[p]);
    double stops = 0.0;
    double stops_covered = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const StopScores& scores = replayed.result.stop_scores[axis][p];
      stops += static_cast<double>(scores.stops());
      stops_covered += scores.coverage95() * static_cast<double>(scores.stops());
    }
    EXPECT_GT(stops, 1000.0);
    EXPECT_NEAR(stops_covered / stops, 0.95, tolerance) << name(kAllPredictors[p]);
    RecordProperty(std::string("coverage_").append(name(kAllPredictors[p])),
                   std::to_string(covered / drives));
  }
}

}  // namespace
}  // namespace zerorate::evaluate

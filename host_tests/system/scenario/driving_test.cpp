// Drives without a fault, among them slow ones: what a node must not mistake for anything else.

#include <gtest/gtest.h>

#include "host_tests/system/scenario/play.hpp"

namespace zerorate::scenario {
namespace {

const evaluate::DriveScores& scores_of(const Played& played, app::Predictor predictor,
                                       std::size_t axis) {
  return played.result.scores[axis][static_cast<std::size_t>(predictor)];
}

/// Expects an honest interval and no complaint; the Kalman predictor's drift over that of the mean
/// of the last stop, all axes.
double ratio_of_good_drives(const Played& played) {
  double kalman = 0.0;
  double mean = 0.0;
  double covered = 0.0;
  double drives = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& scores = scores_of(played, app::Predictor::kalman, axis);
    kalman += std::pow(scores.heading_drift_rms_rad(), 2);
    mean += std::pow(
        scores_of(played, app::Predictor::calibration_mean, axis).heading_drift_rms_rad(), 2);
    drives += static_cast<double>(scores.drives());
    covered += static_cast<double>(scores.drives()) * scores.coverage95();
  }
  // Five standard deviations of a binomial share; neighbouring drives count as independent.
  EXPECT_GT(covered / drives, 0.95 - 5.0 * std::sqrt(0.95 * 0.05 / drives));
  EXPECT_EQ(played.result.samples_disagreeing, 0U);
  EXPECT_EQ(played.result.samples_refused, 0U);
  return std::sqrt(kalman / mean);
}

TEST(City, DriftsLessThanTheMeanOfTheLastStop) {
  EXPECT_LT(ratio_of_good_drives(play("city")), 1.0);
}

// Too few drives to tell which predictor is the better one.
TEST(Motorway, IsNoTrouble) {
  RecordProperty("ratio_x1000", static_cast<int>(1000.0 * ratio_of_good_drives(play("motorway"))));
}

TEST(ParkingCreep, IsNotTakenForStandstill) {
  // Until the first pulse comes, 3 s after it sets off, nothing but the gate can know.
  model::SensorModel model = lsm6dso();
  model.gate = model::Gate{.threshold_sigma = 5.0, .longest_knock_s = 5.0};
  const Played played = play("parking-creep", model);
  EXPECT_EQ(played.samples(core::Motion::still, 66.0, 240.0), 0U);
  EXPECT_GT(played.samples(core::Motion::still, 240.0, 300.0), 52U * 104U);
  EXPECT_LT(played.worst_dps(60.0, 300.0), kWanderDps);
}

TEST(SlowTurn, IsNotLearnt) {
  const Played played = play("slow-turn");
  EXPECT_LT(std::abs(played.mean_dps(120.0, 150.0)), 0.005);
  EXPECT_LT(played.worst_dps(120.0, 150.0), kWanderDps);
  EXPECT_EQ(played.result.samples_disagreeing, 0U);
}

void expect_calibration_at_every_stop(const Played& played) {
  EXPECT_EQ(played.result.samples_disagreeing, 0U);
  for (int stop = 0; stop < 6; ++stop) {
    const double begin_s = 50.0 * stop;
    EXPECT_GT(played.samples(core::Motion::still, begin_s, begin_s + 20.0), 17U * 104U) << stop;
    EXPECT_LT(played.worst_dps(begin_s + 19.0, begin_s + 20.0), kWanderDps) << stop;
  }
}

TEST(IdleVibrationAt22Hz, CalibratesAtEveryStop) {
  expect_calibration_at_every_stop(play("idle-22hz"));
}

TEST(IdleVibrationAt45Hz, CalibratesAtEveryStop) {
  expect_calibration_at_every_stop(play("idle-45hz"));
}

}  // namespace
}  // namespace zerorate::scenario

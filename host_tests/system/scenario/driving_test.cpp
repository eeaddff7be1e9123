// Drives without a fault, among them slow ones: what a node must not mistake for anything else; and
// cars in traffic.

#include <gtest/gtest.h>

#include <cstdio>

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

// Cars in traffic, whose odometer reads zero while they still roll: figures of the node beside
// those with an ideal odometer. Prints the table of docs/reference/scenarios.md.

constexpr std::uint64_t kSeeds = 5;
constexpr double kStanding_m_s = 0.1;

/// Figures of the true drives of kSeeds recordings.
struct Figures {
  double drives = 0.0;
  double squares_deg2 = 0.0;
  double covered = 0.0;
  double worst_dps = 0.0;  ///< error of the bias about z at a true departure

  [[nodiscard]] double rms_deg() const { return std::sqrt(squares_deg2 / drives); }
  [[nodiscard]] double coverage() const { return covered / drives; }

  void add(const Played& played) {
    const evaluate::TrueScore score = played.result.true_drives->score(app::Predictor::kalman);
    const auto count = static_cast<double>(score.drives);
    drives += count;
    squares_deg2 += count * std::pow(score.rms_rad / kDps, 2);
    covered += count * score.coverage95;
    for (std::size_t row = 1; row < played.messages.size(); ++row) {
      const bool departs = double{played.drive.rows[row - 1].row.ref_speed_m_s} < kStanding_m_s &&
                           double{played.drive.rows[row].row.ref_speed_m_s} >= kStanding_m_s;
      if (departs) worst_dps = std::max(worst_dps, played.error_dps(row));
    }
  }
};

/// The drive with an odometer that counts every 0.05 m at once.
simulate::ScenarioDrive with_ideal_odometer(simulate::ScenarioDrive drive) {
  double distance_m = 0.0;
  for (std::size_t row = 1; row < drive.rows.size(); ++row) {
    const std::int64_t elapsed_ns = drive.rows[row].row.time_ns - drive.rows[row - 1].row.time_ns;
    distance_m +=
        double{drive.rows[row].row.ref_speed_m_s} * static_cast<double>(elapsed_ns) * 1e-9;
    drive.rows[row].row.odometer_pulses = static_cast<std::int64_t>(distance_m / 0.05);
  }
  return drive;
}

void print(std::string_view name, const Figures& figures) {
  std::printf("%-13s %3.0f drives, %.2f deg rms, coverage %.2f, bias off by %.3f deg/s\n",
              std::string(name).c_str(), figures.drives, figures.rms_deg(), figures.coverage(),
              figures.worst_dps);
}

class Traffic : public ::testing::TestWithParam<const char*> {};

// Five standard deviations of the share that lies inside the interval.
double least_coverage(const Figures& figures) {
  return 0.95 - 5.0 * std::sqrt(0.95 * 0.05 / figures.drives);
}

// The calm inside the stops is learnt from, whatever the odometer reports.
TEST_P(Traffic, IsNoTroubleWithTheOdometerOfACarNorWithAnIdealOne) {
  Figures car;
  Figures ideal;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    simulate::ScenarioDrive drive = simulate::find_scenario(GetParam()).make(seed);
    ideal.add(play(with_ideal_odometer(drive), lsm6dso(), Scored::against_reference));
    car.add(play(std::move(drive), lsm6dso(), Scored::against_reference));
  }
  print(GetParam(), car);
  print("  ideal", ideal);
  EXPECT_GT(ideal.coverage(), least_coverage(ideal));
  EXPECT_LT(ideal.worst_dps, kWanderDps);
  EXPECT_GT(car.coverage(), least_coverage(car));
  EXPECT_LT(car.worst_dps, kWanderDps);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, Traffic,
                         ::testing::Values("dead-band", "inching", "parking-turn", "speed-by-can"));

}  // namespace
}  // namespace zerorate::scenario

// Errors that rest does not show, and references that teach them: what the interval of the turn
// since departure holds, and how far the error falls. Prints the table of
// docs/reference/scenarios.md.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "host_tests/system/scenario/play.hpp"
#include "host_tools/lib/simulate/motion_scenarios.hpp"

namespace zerorate::scenario {
namespace {

/// Error of the turn since departure at the end of a drive.
struct DriveError {
  double begin_s = 0.0;
  double end_s = 0.0;
  double error_rad = 0.0;
  double sigma_rad = 0.0;
  bool is_referred = false;  ///< a source gave its heading meanwhile
};

double heading_at(const Played& played, double at_s) {
  const double period_s = played.time_s(1);
  const auto row = static_cast<std::size_t>(std::max(0.0, std::round(at_s / period_s)));
  return played.drive.rows[row].true_heading_rad;
}

bool is_referred(const Played& played, double begin_s, double end_s) {
  return std::ranges::any_of(played.drive.references, [&](const auto& reference) {
    return reference.time_s >= begin_s && reference.time_s < end_s;
  });
}

double seconds_of(const app::RateMessage& message) {
  return double{message.turn_time.in_seconds()};
}

/// The turn of every drive, up to where the next one begins: a departure is noticed late, and the
/// turn meanwhile belongs to the drive that begins.
std::vector<DriveError> drive_errors(const Played& played) {
  std::vector<DriveError> errors;
  double begin_s = 0.0;
  for (std::size_t row = 1; row < played.messages.size(); ++row) {
    const bool is_last = row + 1 == played.messages.size();
    const app::RateMessage& message = played.messages[row];
    const double next_s = is_last ? 0.0 : seconds_of(played.messages[row + 1]);
    if (!is_last && next_s >= seconds_of(message)) continue;
    const double end_s = is_last ? played.time_s(row) : played.time_s(row + 1) - next_s;
    const app::AxisTurn& turn = message.up ? message.vertical_turn : message.turn[kYaw];
    if (std::isfinite(turn.sigma.in(core::rad))) {
      const double true_rad = heading_at(played, end_s) - heading_at(played, begin_s);
      errors.push_back({begin_s, end_s, double{turn.angle.in(core::rad)} - true_rad,
                        double{turn.sigma.in(core::rad)}, is_referred(played, begin_s, end_s)});
    }
    begin_s = end_s;
  }
  return errors;
}

/// The first three minutes of motion are those in which a source may still be aligning: drives
/// that begin before this time do not count as taught.
constexpr double kTaught_s = 600.0;

/// Figures of drives of several seeds.
struct MotionFigures {
  double drives = 0.0;
  double squares_deg2 = 0.0;
  double covered = 0.0;

  [[nodiscard]] double rms_deg() const { return std::sqrt(squares_deg2 / drives); }
  [[nodiscard]] double coverage() const { return covered / drives; }
  /// Five standard deviations of a binomial share below 0.95.
  [[nodiscard]] double least_coverage() const {
    return 0.95 - 5.0 * std::sqrt(0.95 * 0.05 / drives);
  }
};

template <class Counts>
MotionFigures figures_of(const std::vector<DriveError>& drives, const Counts& counts) {
  MotionFigures figures;
  for (const DriveError& drive : drives) {
    if (!counts(drive)) continue;
    ++figures.drives;
    figures.squares_deg2 += std::pow(drive.error_rad / kDps, 2);
    figures.covered += std::abs(drive.error_rad) <= 1.96 * drive.sigma_rad ? 1.0 : 0.0;
  }
  return figures;
}

/// Drives of several seeds, alone and with references.
struct DrivesOfSeeds {
  std::vector<DriveError> alone;
  std::vector<DriveError> taught;
};

/// Deviation of the references as a user would state it: the root mean square of those that the
/// source states, 0.1 deg for true headings.
double stated_sigma_rad(const simulate::ScenarioDrive& drive) {
  if (drive.references.empty()) return 0.1 * kDps;
  double squares = 0.0;
  for (const auto& reference : drive.references) squares += std::pow(reference.sigma_rad, 2);
  return std::sqrt(squares / static_cast<double>(drive.references.size()));
}

enum class Teaches : bool { always, only_at_stops };
enum class Accelerometer : bool { no, yes };

DrivesOfSeeds drives_of(const char* name, Teaches teaches, const model::SensorModel& model,
                        std::uint64_t seeds, Accelerometer accelerometer = Accelerometer::no) {
  DrivesOfSeeds drives;
  const auto add = [](const Played& played, std::vector<DriveError>& errors) {
    for (const DriveError& error : drive_errors(played)) errors.push_back(error);
  };
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    simulate::ScenarioDrive drive = simulate::find_scenario(name).make(seed);
    drive.columns.acceleration = accelerometer == Accelerometer::yes;
    const evaluate::ReferenceUse references{.only_at_stops = teaches == Teaches::only_at_stops,
                                            .vertical = {},
                                            .sigma_rad = stated_sigma_rad(drive)};
    add(play(drive, model), drives.alone);
    add(play(drive, model, Scored::no, references), drives.taught);
  }
  return drives;
}

/// Figures of the drives that count, which are printed.
struct Comparison {
  MotionFigures alone;
  MotionFigures taught;

  template <class Counts>
  Comparison(const char* name, const DrivesOfSeeds& drives, const Counts& counts)
      : alone(figures_of(drives.alone, counts)), taught(figures_of(drives.taught, counts)) {
    std::printf("%-24s %3.0f drives, %.2f deg rms, coverage %.2f; taught %.2f deg rms, %.2f\n",
                name, alone.drives, alone.rms_deg(), alone.coverage(), taught.rms_deg(),
                taught.coverage());
  }
};

void expect_honest(const MotionFigures& figures) {
  EXPECT_GT(figures.coverage(), figures.least_coverage());
}

bool is_taught(const DriveError& drive) {
  return drive.begin_s >= kTaught_s;
}

constexpr std::uint64_t kMotionSeeds = 3;

/// Expects honest intervals, and that references leave a share of the error at most.
void expect_taught(const char* name, Teaches teaches, double share,
                   const model::SensorModel& model = lsm6dso()) {
  const Comparison drives{name, drives_of(name, teaches, model, kMotionSeeds), is_taught};
  expect_honest(drives.alone);
  expect_honest(drives.taught);
  EXPECT_LT(drives.taught.rms_deg(), share * drives.alone.rms_deg());
}

TEST(ScaleOnePercent, IsLearntFromTheHeadingAtStops) {
  expect_taught("scale-1-percent", Teaches::only_at_stops, 0.15);
}

// The slope of the place where it parks remains: the tilted axis measures a share of it.
TEST(MountedAskew, IsLearntAsScaleFactorFromTwoAntennas) {
  model::SensorModel model = lsm6dso();
  model.mounting = model::Mounting{.tilt_sigma_rad = 5.0 * kDps};
  expect_taught("mounted-askew", Teaches::always, 0.4, model);
}

// A model that says nothing of the mounting leaves the slopes out of the interval.
TEST(MountedAskew, IsLearntFromTwoAntennasByAModelOfAVerticalAxis) {
  const Comparison drives{"mounted-askew, silent",
                          drives_of("mounted-askew", Teaches::always, lsm6dso(), kMotionSeeds),
                          is_taught};
  expect_honest(drives.alone);
  EXPECT_LT(drives.taught.rms_deg(), 0.4 * drives.alone.rms_deg());
}

// Without references the interval does not hold: nothing shows that the bias is another in motion.
TEST(MotorwayHour, IsKnownByTheCourse) {
  const Comparison hours{"motorway-hour", drives_of("motorway-hour", Teaches::always, lsm6dso(), 5),
                         [](const DriveError&) { return true; }};
  expect_honest(hours.taught);
  EXPECT_LT(hours.taught.rms_deg(), 0.1 * hours.alone.rms_deg());
}

// On the ramps a taught node is too sure of its turn: its interval has no room for slopes.
TEST(CarPark, LeavesWithWhatTheStreetsTaught) {
  const DrivesOfSeeds drives = drives_of("car-park", Teaches::always, lsm6dso(), kMotionSeeds);
  const Comparison all{"car-park", drives, [](const DriveError&) { return true; }};
  const Comparison inside{"car-park, ramps", drives,
                          [](const DriveError& drive) { return !drive.is_referred; }};
  const Comparison streets{"car-park, streets", drives, [](const DriveError& drive) {
                             return drive.is_referred && is_taught(drive);
                           }};
  expect_honest(all.alone);
  expect_honest(inside.alone);
  expect_honest(streets.taught);
  EXPECT_LT(streets.taught.rms_deg(), 0.4 * streets.alone.rms_deg());
}

// The turn about the vertical is the same on a ramp: what the streets taught holds inside.
TEST(CarPark, IsAStreetLikeAnyToANodeWithAnAccelerometer) {
  const DrivesOfSeeds drives =
      drives_of("car-park", Teaches::always, lsm6dso(), kMotionSeeds, Accelerometer::yes);
  const Comparison inside{"car-park, ramps, forces", drives,
                          [](const DriveError& drive) { return !drive.is_referred; }};
  const Comparison streets{"car-park, streets, forces", drives, [](const DriveError& drive) {
                             return drive.is_referred && is_taught(drive);
                           }};
  expect_honest(inside.alone);
  expect_honest(inside.taught);
  expect_honest(streets.taught);
  EXPECT_LT(inside.taught.rms_deg(), 0.5 * inside.alone.rms_deg());
}

// Nothing is left to teach but the bias: the scale factor of the scenario is right.
TEST(MountedAskew, IsNoErrorToANodeWithAnAccelerometer) {
  const Comparison drives{
      "mounted-askew, forces",
      drives_of("mounted-askew", Teaches::always, lsm6dso(), kMotionSeeds, Accelerometer::yes),
      is_taught};
  expect_honest(drives.alone);
  expect_honest(drives.taught);
  EXPECT_LT(drives.alone.rms_deg(), 0.3);
}

TEST(SpinningRobot, IsLearntFromAMark) {
  model::SensorModel model = lsm6dso();
  model.scale_factor =
      model::ScaleFactor{.sigma = 0.01, .asymmetry_sigma = simulate::kRobotAsymmetry};
  const Comparison moves{"spinning-robot",
                         drives_of("spinning-robot", Teaches::only_at_stops, model, kMotionSeeds),
                         is_taught};
  expect_honest(moves.alone);
  expect_honest(moves.taught);
  EXPECT_LT(moves.taught.rms_deg(), 0.2 * moves.alone.rms_deg());
}

// A model that is silent about the asymmetry leaves it out of the interval.
TEST(SpinningRobot, IsLearntFromAMarkByASymmetricModel) {
  const Comparison moves{
      "spinning-robot, symmetric",
      drives_of("spinning-robot", Teaches::only_at_stops, lsm6dso(), kMotionSeeds), is_taught};
  expect_honest(moves.alone);
  EXPECT_LT(moves.taught.rms_deg(), 0.2 * moves.alone.rms_deg());
}

}  // namespace
}  // namespace zerorate::scenario

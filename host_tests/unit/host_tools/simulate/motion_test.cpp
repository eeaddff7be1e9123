// Errors of a gyro in motion, streets, and sources of the heading: each measured in what it gives.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/gyro_in_motion.hpp"
#include "host_tools/lib/simulate/heading_references.hpp"
#include "host_tools/lib/simulate/scenario.hpp"
#include "host_tools/lib/simulate/streets.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::simulate {
namespace {

using Rates = std::array<double, 3>;
constexpr double kDeg = units::kRadPerDeg;
constexpr double kStep_s = 0.01;

TEST(MotionErrors, AreAbsentByDefaultBitForBit) {
  const Rates rates{0.1, -0.37, 2.9};
  EXPECT_EQ(MotionErrors{}.measured(rates), rates);
  EXPECT_EQ(MotionErrors{}.offset(2, 33.0), 0.0);
}

TEST(MotionErrors, ScaleBothSensesByTheirOwnFactor) {
  const MotionErrors errors{.scale_factor = {0.0, 0.0, 0.01}, .asymmetry = {0.0, 0.0, 0.002}};
  EXPECT_DOUBLE_EQ(errors.measured({0.0, 0.0, 1.0})[2], 1.012);
  EXPECT_DOUBLE_EQ(errors.measured({0.0, 0.0, -1.0})[2], -1.008);
}

TEST(MotionErrors, OffsetGrowsInProportionToTheSpeed) {
  const MotionErrors errors{.offset_rad_s = {0.0, 0.0, 1e-4}};
  EXPECT_DOUBLE_EQ(errors.offset(2, 10.0), 1e-4);
  EXPECT_DOUBLE_EQ(errors.offset(2, 25.0), 2.5e-4);
  EXPECT_EQ(errors.offset(2, 0.0), 0.0);
}

TEST(Tilt, TurnsTheVerticalTowardsTheOtherAxes) {
  const Rates up{0.0, 0.0, 1.0};
  const Rates rolled = seen_by({.roll_rad = 5.0 * kDeg}, up);
  EXPECT_NEAR(rolled[1], std::sin(5.0 * kDeg), 1e-15);
  EXPECT_NEAR(rolled[2], std::cos(5.0 * kDeg), 1e-15);
  // The nose sinks: it points away from the vertical.
  EXPECT_NEAR(seen_by({.pitch_rad = 5.0 * kDeg}, up)[0], -std::sin(5.0 * kDeg), 1e-15);
}

TEST(Tilt, KeepsTheLengthOfAVector) {
  const Rates tilted = seen_by({.roll_rad = 0.3, .pitch_rad = -0.7}, {0.2, -0.5, 0.9});
  double squares = 0.0;
  for (const double component : tilted) squares += component * component;
  EXPECT_NEAR(squares, 0.04 + 0.25 + 0.81, 1e-14);
}

double degrees_turned(const Route& route) {
  const VehicleMotion motion = follow(route.legs(), kStep_s);
  double turned = 0.0;
  for (const double rate : motion.turn_rad_s) turned += rate * kStep_s;
  return turned / kDeg;
}

/// Between two stretches straight on.
template <class Manoeuvre>
double degrees_of(const Manoeuvre& manoeuvre) {
  Route route;
  route.stand(5.0);
  route.straight(5.0, 10.0);
  manoeuvre(route);
  route.straight(5.0, 10.0);
  route.stand(5.0);
  return degrees_turned(route);
}

TEST(Route, TurnsByWhatItsManoeuvresSay) {
  // A step at both ramps of 14 to 38 deg/s, sampled each 0.01 s.
  constexpr double kSampled_deg = 0.5;
  EXPECT_NEAR(degrees_of([](Route& route) { route.corner(1.0); }), 90.0, kSampled_deg);
  EXPECT_NEAR(degrees_of([](Route& route) { route.corner(-1.0); }), -90.0, kSampled_deg);
  EXPECT_NEAR(degrees_of([](Route& route) { route.u_turn(); }), 180.0, kSampled_deg);
  EXPECT_NEAR(degrees_of([](Route& route) { route.roundabout(-90.0); }), -90.0, kSampled_deg);
  EXPECT_NEAR(degrees_of([](Route& route) { route.roundabout(180.0); }), 180.0, kSampled_deg);
  EXPECT_NEAR(degrees_of([](Route& route) { route.turn(540.0, 9.0, 3.5); }), 540.0, kSampled_deg);
}

TEST(Route, RefusesWhatIsNoTurn) {
  Route route;
  EXPECT_THROW(route.turn(0.0, 9.0, 3.5), std::invalid_argument);
  EXPECT_THROW(route.turn(90.0, 0.0, 3.5), std::invalid_argument);
  EXPECT_THROW(route.turn(90.0, 9.0, 0.0), std::invalid_argument);
  EXPECT_THROW(route.stand(-1.0), std::invalid_argument);
}

TEST(Grade, SharesTheTurnAmongTheAxesOfTheBody) {
  Route route;
  route.straight(5.0, 5.0, 0.1);
  route.turn(360.0, 10.0, 5.0, 0.1);
  const VehicleMotion motion = follow(route.legs(), kStep_s);
  const std::size_t turning = motion.size() - 1;
  const double turn = motion.turn_rad_s[turning];
  const double pitch = std::atan(0.1);
  // The nose is up, and the body leans outwards by 5 deg per g.
  const double lean = 5.0 * std::numbers::pi / 180.0 * 5.0 * turn / 9.80665;
  EXPECT_NEAR(motion.rate_rad_s[turning][0], turn * std::sin(pitch), 1e-12);
  EXPECT_NEAR(motion.rate_rad_s[turning][1], turn * std::cos(pitch) * std::sin(lean), 0.0041);
  EXPECT_NEAR(motion.rate_rad_s[turning][2], turn * std::cos(pitch) * std::cos(lean), 1e-12);
  // The force of gravity along the road, and what the turn pushes outwards.
  EXPECT_NEAR(motion.force_g[turning][0], std::sin(pitch), 1e-12);
  const double outwards = std::cos(lean) * 5.0 * turn / 9.80665;
  EXPECT_NEAR(motion.force_g[turning][1], outwards + std::sin(lean) * std::cos(pitch), 1e-12);
}

TEST(Grade, IsTheIntegralOfThePitch) {
  Route route;
  route.straight(5.0, 5.0);
  route.straight(5.0, 5.0, 0.1);
  const VehicleMotion motion = follow(route.legs(), kStep_s);
  double pitched = 0.0;
  for (const Rates& rate : motion.rate_rad_s) pitched += rate[1] * kStep_s;
  // The nose goes up by a negative rotation about y; the road makes it nod by 0.0004 rad at most.
  EXPECT_NEAR(pitched, -std::atan(0.1), 0.0005);
}

TEST(Streets, AreMixedBetweenStopsAndEndAtRest) {
  const auto legs = drive_in_streets({.duration_s = 20'000.0}, random::RandomStream{3});
  const VehicleMotion motion = follow(legs, 0.1);
  double least_grade = 0.0;
  double most_grade = 0.0;
  int stops = 0;
  for (const Leg& leg : legs) {
    least_grade = std::min(least_grade, leg.grade);
    most_grade = std::max(most_grade, leg.grade);
    stops += leg.speed_m_s == 0.0 ? 1 : 0;
  }
  EXPECT_LT(least_grade, -0.03);
  EXPECT_GE(least_grade, -0.10);
  EXPECT_GT(most_grade, 0.03);
  EXPECT_LE(most_grade, 0.10);
  EXPECT_GT(stops, 100);
  EXPECT_EQ(motion.speed_m_s.back(), 0.0);
}

TEST(Streets, AreTheSameForASeedAndOthersForAnother) {
  const auto length_s = [](std::uint64_t seed) {
    double length = 0.0;
    for (const Leg& leg : drive_in_streets({}, random::RandomStream{seed})) length += leg.length_s;
    return length;
  };
  EXPECT_EQ(length_s(1), length_s(1));
  EXPECT_NE(length_s(1), length_s(2));
}

/// Straight on at one speed, heading 1 rad.
struct Steady {
  explicit Steady(double speed, double length_s = 20'000.0)
      : heading_rad(static_cast<std::size_t>(std::lround(length_s / kPeriod_s)), 1.0),
        speed_m_s(heading_rad.size(), speed) {}

  [[nodiscard]] TrueCourse course() const {
    return {.period_s = kPeriod_s, .heading_rad = heading_rad, .speed_m_s = speed_m_s};
  }

  static constexpr double kPeriod_s = 0.1;
  std::vector<double> heading_rad;
  std::vector<double> speed_m_s;
};

double rms_error(const std::vector<SensedHeading>& headings, double true_rad) {
  double squares = 0.0;
  for (const SensedHeading& each : headings) squares += std::pow(each.heading_rad - true_rad, 2);
  return std::sqrt(squares / static_cast<double>(headings.size()));
}

/// Five standard deviations of a root mean square of so many.
double rms_tolerance(const std::vector<SensedHeading>& headings) {
  return 5.0 / std::sqrt(2.0 * static_cast<double>(headings.size()));
}

TEST(GnssCourse, ErrsInInverseProportionToTheSpeed) {
  for (const double speed_m_s : {6.0, 10.0, 30.0}) {
    const auto headings = GnssCourse{}.sense(Steady{speed_m_s}.course(), random::RandomStream{1});
    ASSERT_EQ(headings.size(), 20'000U);
    const double sigma_rad = 0.012 * 10.0 / speed_m_s;
    EXPECT_DOUBLE_EQ(headings.front().sigma_rad, sigma_rad);
    EXPECT_NEAR(rms_error(headings, 1.0) / sigma_rad, 1.0, rms_tolerance(headings));
  }
}

TEST(GnssCourse, IsSilentBelowItsSpeed) {
  EXPECT_TRUE(GnssCourse{}.sense(Steady{4.9}.course(), random::RandomStream{1}).empty());
}

TEST(GnssCourse, IsLate) {
  Steady steady{10.0, 100.0};
  for (std::size_t k = 0; k < steady.heading_rad.size(); ++k) {
    steady.heading_rad[k] = 0.1 * static_cast<double>(k) * Steady::kPeriod_s;
  }
  const GnssCourse receiver{.sigma_at_10_m_s_rad = 0.0, .delay_s = 0.5};
  for (const SensedHeading& each : receiver.sense(steady.course(), random::RandomStream{1})) {
    EXPECT_NEAR(each.heading_rad, 0.1 * (each.time_s - 0.5), 1e-12);
  }
}

TEST(GnssCourse, IsOutForTheShareThatItsOutagesHave) {
  const GnssCourse receiver{.outages = {.mean_between_s = 80.0, .mean_length_s = 20.0}};
  const auto headings = receiver.sense(Steady{10.0, 200'000.0}.course(), random::RandomStream{1});
  // A cycle of 100 s has 20 s of outage on average; of 2000 cycles the share is known to 0.006.
  EXPECT_NEAR(static_cast<double>(headings.size()) / 200'000.0, 0.8, 5.0 * 0.006);
}

TEST(GnssCourse, JumpsByReflectionsThatDecay) {
  const GnssCourse receiver{
      .sigma_at_10_m_s_rad = 0.0,
      .multipath = {.mean_between_s = 100.0, .jump_sigma_rad = 0.2, .decay_s = 5.0}};
  const auto headings = receiver.sense(Steady{10.0}.course(), random::RandomStream{1});
  int jumps = 0;
  for (std::size_t k = 1; k < headings.size(); ++k) {
    const double before = headings[k - 1].heading_rad - 1.0;
    const double now = headings[k].heading_rad - 1.0;
    const double decayed = before * std::exp(-1.0 / 5.0);
    jumps += std::abs(now - decayed) > 1e-9 ? 1 : 0;
  }
  // 200 in 20 000 s: a Poisson number.
  EXPECT_NEAR(jumps, 200.0, 5.0 * std::sqrt(200.0));
}

TEST(TwoAntennas, GiveAHeadingAtRestByTheirBaseline) {
  const TwoAntennas antennas{.rate_hz = 10.0, .baseline_m = 2.0, .position_sigma_m = 0.01};
  const auto headings = antennas.sense(Steady{0.0, 1'000.0}.course(), random::RandomStream{1});
  ASSERT_EQ(headings.size(), 10'000U);
  EXPECT_NEAR(rms_error(headings, 1.0) / 0.005, 1.0, rms_tolerance(headings));
}

TEST(Mark, IsReadOnceInEachStopThatIsLongEnough) {
  Steady steady{1.0, 100.0};
  const auto stand = [&](double from_s, double to_s) {
    for (auto k = static_cast<std::size_t>(from_s * 10.0);
         k < static_cast<std::size_t>(to_s * 10.0); ++k) {
      steady.speed_m_s[k] = 0.0;
    }
  };
  stand(10.0, 20.0);
  stand(30.0, 33.0);
  stand(50.0, 60.0);
  const auto headings = Mark{}.sense(steady.course(), random::RandomStream{1});
  ASSERT_EQ(headings.size(), 2U);
  EXPECT_NEAR(headings[0].time_s, 14.0, 1e-9);
  EXPECT_NEAR(headings[1].time_s, 54.0, 1e-9);
}

TEST(SourcesOfTheHeading, RefuseRatesAboveThatOfTheSamples) {
  const Steady steady{10.0, 10.0};
  const random::RandomStream stream{1};
  EXPECT_THROW((void)(GnssCourse{.rate_hz = 20.0}.sense(steady.course(), stream)),
               std::invalid_argument);
  EXPECT_THROW((void)(TwoAntennas{.baseline_m = 0.0}.sense(steady.course(), stream)),
               std::invalid_argument);
}

TEST(References, StandInTheirRowsAndNowhereElse) {
  ScenarioDrive drive =
      record(follow(std::vector<Leg>{{10.0, 10.0, 5.0}}, kScenarioPeriod_s), {}, 1);
  show_references({{.time_s = 2.0, .heading_rad = -0.5}, {.time_s = 99.0, .heading_rad = 1.0}},
                  drive);
  const auto has_heading = [](const ScenarioRow& row) {
    return std::isfinite(row.row.ref_heading_rad);
  };
  ASSERT_EQ(std::ranges::count_if(drive.rows, has_heading), 1);
  const auto row = std::ranges::find_if(drive.rows, has_heading);
  EXPECT_GE(row->row.time_ns, 2'000'000'000);
  EXPECT_LT(row->row.time_ns, 2'010'000'000);
  EXPECT_FLOAT_EQ(row->row.ref_heading_rad, static_cast<float>(2.0 * std::numbers::pi - 0.5));
}

TEST(Recording, HoldsTheTrueHeadingBesideTheMeasuredRate) {
  const VehicleMotion motion = follow(std::vector<Leg>{{100.0, 10.0, 9.0}}, kScenarioPeriod_s);
  const ScenarioDrive drive = record(
      motion,
      {.errors = {.scale_factor = {0.0, 0.0, 0.01}, .offset_rad_s = {0.0, 0.0, 0.1 * kDeg}}}, 1);
  EXPECT_NEAR(drive.rows.back().true_heading_rad, 900.0 * kDeg, 0.2 * kDeg);
  double measured = 0.0;
  double biases = 0.0;
  for (const ScenarioRow& row : drive.rows) {
    measured += double{row.row.rate_rad_s[2]} * kScenarioPeriod_s;
    biases += double{row.bias_rad_s[2]} * kScenarioPeriod_s;
  }
  // White noise of 0.0027 deg/s/sqrt(Hz) over 100 s: five times 0.027 deg.
  EXPECT_NEAR(measured - biases, 1.01 * 900.0 * kDeg, 0.2 * kDeg);
  // 0.1 deg/s of bias at rest, and as much in motion.
  EXPECT_NEAR(biases, 20.0 * kDeg, 1.0 * kDeg);
}

}  // namespace
}  // namespace zerorate::simulate

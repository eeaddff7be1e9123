#include "host_tools/lib/simulate/motion_scenarios.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "host_tools/lib/simulate/draws.hpp"
#include "host_tools/lib/simulate/heading_references.hpp"
#include "host_tools/lib/simulate/streets.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::simulate {
namespace {

using units::kRadPerDeg;

constexpr double kScale = 0.01;
const MotionErrors kScaleError{.scale_factor = {kScale, kScale, kScale}};

/// The headings of a source in the place of the true ones, all but those that `is_hidden` names.
template <class Source, class IsHidden>
void refer(const Source& source, const VehicleMotion& motion, std::uint64_t seed,
           const IsHidden& is_hidden, ScenarioDrive& drive) {
  std::vector<double> heading_rad;
  heading_rad.reserve(drive.rows.size());
  for (const ScenarioRow& row : drive.rows) heading_rad.push_back(row.true_heading_rad);
  std::vector<SensedHeading> headings =
      source.sense({.period_s = motion.sample_period_s,
                    .heading_rad = heading_rad,
                    .speed_m_s = motion.speed_m_s},
                   random::RandomStream{seed}.substream("references"));
  std::erase_if(headings, [&](const SensedHeading& each) { return is_hidden(each.time_s); });
  show_references(std::move(headings), drive);
}

template <class Source>
void refer(const Source& source, const VehicleMotion& motion, std::uint64_t seed,
           ScenarioDrive& drive) {
  refer(
      source, motion, seed, [](double) { return false; }, drive);
}

VehicleMotion streets(const StreetParams& params, std::uint64_t seed) {
  return follow(drive_in_streets(params, random::RandomStream{seed}), kScenarioPeriod_s);
}

/// Bends of 1 to 2 km radius, straights between them, some of them with a grade.
std::vector<Leg> motorway_legs(std::uint64_t seed) {
  constexpr double kSpeed_m_s = 33.0;
  constexpr double kLength_s = 3600.0;
  Draws draws{random::RandomStream{seed}.substream("motorway")};
  Route route;
  route.stand(60.0);
  const double begin_s = route.length_s();
  while (route.length_s() < begin_s + kLength_s) {
    const double straight_s = 10.0 + draws.exponential(50.0);
    const double grade = draws.happens(0.3) ? draws.uniform(-0.04, 0.04) : 0.0;
    const double side = draws.happens(0.5) ? 1.0 : -1.0;
    const double angle_deg = draws.uniform(10.0, 60.0);
    const double radius_m = draws.uniform(1000.0, 2000.0);
    route.straight(straight_s, kSpeed_m_s, grade);
    route.turn(side * angle_deg, radius_m, kSpeed_m_s, grade);
  }
  route.stand(60.0);
  return route.legs();
}

/// Up a ramp that winds by 540 deg, along the rows of a floor, a wait for a place.
void park(Draws& draws, Route& route) {
  constexpr double kRamp = 0.10;
  constexpr double kBank = 0.03;
  route.turn(540.0, 9.0, 3.5, kRamp, kBank);
  for (int row = 0; row < 4; ++row) {
    const double side = draws.happens(0.5) ? 1.0 : -1.0;
    const double straight_s = draws.uniform(4.0, 10.0);
    route.straight(straight_s, 3.0);
    route.turn(90.0 * side, 5.5, 2.0);
  }
  route.straight(1.0, 1.0);
  route.stand(draws.uniform(10.0, 40.0));
  route.turn(-540.0, 9.0, 3.5, -kRamp, -kBank);
  route.straight(3.0, 3.0);
  route.stand(draws.uniform(6.0, 12.0));  // at the barrier
}

}  // namespace

ScenarioDrive scale_1_percent(std::uint64_t seed) {
  return record(streets({}, seed), {.errors = kScaleError}, seed);
}

ScenarioDrive mounted_askew(std::uint64_t seed) {
  const VehicleMotion motion = streets({}, seed);
  ScenarioDrive drive =
      record(motion, {.errors = {.mounting = {.roll_rad = 5.0 * kRadPerDeg}}}, seed);
  refer(TwoAntennas{}, motion, seed, drive);
  return drive;
}

ScenarioDrive motorway_hour(std::uint64_t seed) {
  constexpr double kOffset_rad_s = 0.004 * kRadPerDeg;  // 0.013 deg/s at 33 m/s
  const VehicleMotion motion = follow(motorway_legs(seed), kScenarioPeriod_s);
  MotionErrors errors = kScaleError;
  errors.offset_rad_s = {kOffset_rad_s, kOffset_rad_s, kOffset_rad_s};
  ScenarioDrive drive = record(motion, {.errors = errors}, seed);
  refer(GnssCourse{.outages = {.mean_between_s = 300.0, .mean_length_s = 30.0},
                   .multipath = {.mean_between_s = 600.0}},
        motion, seed, drive);
  return drive;
}

ScenarioDrive car_park(std::uint64_t seed) {
  constexpr double kStreets_s = 900.0;
  Draws draws{random::RandomStream{seed}.substream("car-park")};
  const random::RandomStream stream{seed};
  std::vector<Leg> legs = drive_in_streets({.duration_s = kStreets_s}, stream.substream("before"));
  Route inside;
  for (int visit = 0; visit < 3; ++visit) park(draws, inside);
  const std::vector<Leg> after =
      drive_in_streets({.duration_s = kStreets_s}, stream.substream("after"));
  double enters_s = 0.0;
  for (const Leg& leg : legs) enters_s += leg.length_s;
  legs.insert(legs.end(), inside.legs().begin(), inside.legs().end());
  legs.insert(legs.end(), after.begin(), after.end());
  const VehicleMotion motion = follow(legs, kScenarioPeriod_s);
  ScenarioDrive drive = record(motion, {.errors = kScaleError}, seed);
  const double leaves_s = enters_s + inside.length_s();
  refer(
      GnssCourse{.multipath = {.mean_between_s = 120.0}}, motion, seed,
      [&](double t_s) { return t_s >= enters_s && t_s < leaves_s; }, drive);
  return drive;
}

ScenarioDrive spinning_robot(std::uint64_t seed) {
  constexpr double kHalfTrack_m = 0.25;
  constexpr double kShake_rad_s = 0.3 * kRadPerDeg;  // hard wheels on tiles, at 7 Hz
  Draws draws{random::RandomStream{seed}.substream("robot")};
  std::vector<Leg> legs{{.length_s = 30.0}};
  for (int move = 0; move < 60; ++move) {
    const double sense = draws.happens(0.5) ? 1.0 : -1.0;
    const double spin_dps = draws.uniform(30.0, 90.0);
    const double turned_deg = draws.uniform(90.0, 900.0);
    const double driven_s = draws.uniform(2.0, 10.0);
    legs.push_back({turned_deg / spin_dps, 0.0, sense * spin_dps});
    legs.push_back({.length_s = 1.0});
    legs.push_back({driven_s, 0.8});
    legs.push_back({.length_s = draws.uniform(8.0, 20.0)});
  }
  VehicleMotion motion = follow(legs, kScenarioPeriod_s);
  for (std::size_t k = 0; k < motion.size(); ++k) {
    // Its wheels count also where they turn against each other.
    motion.speed_m_s[k] += std::abs(motion.turn_rad_s[k]) * kHalfTrack_m;
    const double phase = 2.0 * std::numbers::pi * 7.0 * static_cast<double>(k) * kScenarioPeriod_s;
    if (motion.speed_m_s[k] > 0.0) motion.rate_rad_s[k][1] += kShake_rad_s * std::sin(phase);
  }
  motion.odometer_pulses =
      count_pulses(motion.speed_m_s, kScenarioPeriod_s, {.metres_per_pulse = 0.005});
  MotionErrors errors = kScaleError;
  errors.asymmetry = {0.0, 0.0, kRobotAsymmetry};
  ScenarioDrive drive = record(motion, {.errors = errors}, seed);
  refer(Mark{}, motion, seed, drive);
  return drive;
}

}  // namespace zerorate::simulate

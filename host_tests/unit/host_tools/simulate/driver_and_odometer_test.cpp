// Habits of the simulated driver, measured in its legs; and the scenarios that it drives.

#include "host_tools/lib/simulate/vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/odometry/odometer_figures.hpp"
#include "host_tools/lib/simulate/scenario.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::simulate {
namespace {

constexpr std::size_t kYaw = 2;

struct Habits {
  int stops = 0;
  int creeps = 0;
  int inches = 0;
  double stops_s = 0.0;
  std::vector<double> radii_m;
  std::vector<double> accelerations_m_s2;
};

Habits habits_of(const DriverParams& params) {
  Habits habits;
  const auto legs = drive_in_traffic(params, random::RandomStream{7});
  for (std::size_t i = 1; i < legs.size(); ++i) {
    const Leg& leg = legs[i];
    const bool was_at_rest = legs[i - 1].speed_m_s == 0.0;
    const bool creeps = leg.speed_m_s > 0.0 && leg.speed_m_s < 1.0 && leg.length_s > leg.ramp_s;
    if (leg.speed_m_s == 0.0) {
      ++habits.stops;
      habits.stops_s += leg.length_s - leg.ramp_s;
    }
    if (creeps) ++habits.creeps;
    if (creeps) {
      habits.radii_m.push_back(leg.speed_m_s / std::abs(leg.turn_dps * units::kRadPerDeg));
    }
    if (creeps && was_at_rest && legs[i + 1].speed_m_s == 0.0) ++habits.inches;
    if (was_at_rest && leg.speed_m_s > 1.0) {
      habits.accelerations_m_s2.push_back(leg.speed_m_s / leg.ramp_s);
    }
  }
  return habits;
}

constexpr double kLong_s = 200'000.0;

TEST(Driver, StopsAndCreepsAsOftenAsToldTo) {
  const Habits habits = habits_of(
      {.duration_s = kLong_s, .mean_stop_s = 14.0, .creeping_share = 0.3, .inches_per_stop = 0.3});
  ASSERT_GT(habits.stops, 1'000);
  // An exponential's mean is known to its value over the root of the number; five of those.
  const double stop_s = habits.stops_s / habits.stops;
  EXPECT_NEAR(stop_s, 2.0 + 14.0, 5.0 * 14.0 / std::sqrt(habits.stops));
  // Moves forward follow a geometric distribution: variance m (1 + m).
  const int first_stops = habits.stops - habits.inches;
  EXPECT_NEAR(static_cast<double>(habits.inches) / first_stops, 0.3,
              5.0 * std::sqrt(0.3 * 1.3 / first_stops));
}

TEST(Driver, TurnsWithinItsRadiiAndPullsAwayWithinItsAccelerations) {
  const Habits habits = habits_of({.duration_s = kLong_s,
                                   .pulls_away_with_m_s2 = 0.7,
                                   .tightest_bend_m = 5.0,
                                   .widest_bend_m = 80.0});
  double sum = 0.0;
  for (const double radius_m : habits.radii_m) {
    EXPECT_GE(radius_m, 5.0 - 1e-9);
    EXPECT_LE(radius_m, 80.0 + 1e-9);
    sum += std::log(radius_m / 5.0);
  }
  // Uniform between 0 and log 16: its standard deviation is log 16 / sqrt(12).
  const auto creeps = static_cast<double>(habits.radii_m.size());
  EXPECT_NEAR(sum / creeps, 0.5 * std::log(16.0), 5.0 * std::log(16.0) / std::sqrt(12.0 * creeps));
  for (const double acceleration : habits.accelerations_m_s2) {
    EXPECT_GE(acceleration, 0.6 * 0.7 - 1e-9);
    EXPECT_LE(acceleration, 1.4 * 0.7 + 1e-9);
  }
}

TEST(Driver, IsTheSameForASeedAndEndsAtRest) {
  const auto legs = drive_in_traffic({}, random::RandomStream{3});
  const auto again = drive_in_traffic({}, random::RandomStream{3});
  const auto other = drive_in_traffic({}, random::RandomStream{4});
  ASSERT_EQ(legs.size(), again.size());
  EXPECT_EQ(legs.back().length_s, again.back().length_s);
  EXPECT_NE(legs[1].turn_dps, other[1].turn_dps);
  EXPECT_EQ(legs.back().speed_m_s, 0.0);
}

// The order of the draws is the driver's and not the compiler's: a seed is the same drive with all.
TEST(Driver, DrawsTheSameLegsWithEveryCompiler) {
  const auto legs = drive_in_traffic({.creeping_share = 1.0}, random::RandomStream{3});
  const std::vector<Leg> expected{{30.2, 0.0, 0.0, 0.2},  // stands, creeps, pulls away, cruises
                                  {3.348372, 0.465003, 0.021062, 0.572830},
                                  {2.035567, 2.0, 0.245917, 2.035567},
                                  {12.416538, 5.731424, 0.0, 3.467330},
                                  {4.2, 5.731424, 0.756702, 0.2}};
  ASSERT_GT(legs.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(legs[i].length_s, expected[i].length_s, 1e-6) << i;
    EXPECT_NEAR(legs[i].speed_m_s, expected[i].speed_m_s, 1e-6) << i;
    EXPECT_NEAR(legs[i].turn_dps, expected[i].turn_dps, 1e-6) << i;
    EXPECT_NEAR(legs[i].ramp_s, expected[i].ramp_s, 1e-6) << i;
  }
}

/// The scenario as a recording of both speeds at 10.4 Hz, its odometer by pulses.
odometry::OdometerFigures figures_of(std::string_view name) {
  const ScenarioDrive drive = find_scenario(name).make(1);
  constexpr std::size_t kEvery = 10;
  odometry::SpeedRecord record{.name = std::string(name), .counts_pulses = true};
  for (std::size_t k = kEvery; k < drive.rows.size(); k += kEvery) {
    const recording::Row& row = drive.rows[k].row;
    const auto pulses = row.odometer_pulses - drive.rows[k - kEvery].row.odometer_pulses;
    record.time_s.push_back(static_cast<double>(row.time_ns) * 1e-9);
    record.reference_m_s.push_back(double{row.ref_speed_m_s});
    record.odometer_m_s.push_back(0.05 * static_cast<double>(pulses) * 10.4);
    record.yaw_rad_s.push_back(double{row.ref_rate_rad_s});
  }
  return odometry::measure_odometer(record);
}

/// 0.83 m/s, and 0.6 s of message and row later at 0.9 m/s2 and 40 % more.
constexpr double kFastestRolling_m_s = 0.83 + 0.6 * 1.4 * 0.9;

double fastest_dps(const odometry::Rolling& rolling) {
  return rolling.turning_rad_s.back() * units::kDegPerRad;
}

TEST(DeadBandScenario, RollsAtZeroAsRealCarsDo) {
  const auto figures = figures_of("dead-band");
  RecordProperty("share_x1000", static_cast<int>(1000.0 * figures.rolling.share.value));
  // 95 % intervals of the three real drives: 2.1 to 18.0 %.
  EXPECT_GT(figures.rolling.share.value, 0.021);
  EXPECT_LT(figures.rolling.share.value, 0.180);
  EXPECT_LT(figures.rolling.speeds_m_s.back(), kFastestRolling_m_s);
  // Recorded gyro of the only real drive that has one: median 0.025, at most 1.42 deg/s.
  EXPECT_GT(fastest_dps(figures.rolling), 0.2);
  EXPECT_LT(fastest_dps(figures.rolling), 4.0);
  EXPECT_GT(figures.leaves_zero_m_s.median.value, 0.75);
  EXPECT_LT(figures.leaves_zero_m_s.median.value, 1.3);
}

TEST(InchingScenario, MovesForwardWithinItsStops) {
  const auto figures = figures_of("inching");
  const auto inching = static_cast<std::size_t>(odometry::Situation::inching);
  EXPECT_GT(figures.rolling_by_situation[inching].share.value, 0.05);
}

TEST(ParkingTurnScenario, TurnsAsTightlyAsACar) {
  const auto figures = figures_of("parking-turn");
  EXPECT_GT(fastest_dps(figures.rolling), 5.0);
  // In a bend of 4 m at the fastest rolling of DeadBandScenario.
  EXPECT_LT(fastest_dps(figures.rolling), kFastestRolling_m_s / 4.0 * units::kDegPerRad);
}

TEST(Scenarios, HaveAReferenceThatIsTheTruth) {
  for (const char* const name : {"slow-turn", "carousel"}) {
    const ScenarioDrive drive = find_scenario(name).make(1);
    ASSERT_TRUE(drive.columns.ref_heading && drive.columns.ref_rate && drive.columns.ref_speed);
    for (const ScenarioRow& row : drive.rows) {
      // A body that leans by a degree measures 0.015 % less.
      ASSERT_NEAR(row.row.ref_rate_rad_s, row.true_rate_rad_s[kYaw],
                  1.5e-4F * std::abs(row.row.ref_rate_rad_s))
          << name;
    }
  }
}

TEST(Scenarios, HaveAHeadingThatIsTheIntegralOfTheRate) {
  const ScenarioDrive drive = find_scenario("parking-turn").make(1);
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double heading = 0.0;
  for (std::size_t k = 1; k < drive.rows.size(); ++k) {
    const double before = double{drive.rows[k - 1].row.ref_heading_rad};
    heading += double{drive.rows[k - 1].true_rate_rad_s[kYaw]} / 104.0;
    ASSERT_GE(before, 0.0);
    ASSERT_LE(before, kTurn);
  }
  const double difference = heading - double{drive.rows.back().row.ref_heading_rad};
  EXPECT_NEAR(std::remainder(difference, kTurn), 0.0, 1e-4);
}

constexpr double kPeriod_s = 0.01;

/// Half an hour: 20 s of rest, up to 10 m/s at 0.5 m/s2, down again, and so on.
std::vector<double> drive() {
  std::vector<double> speed;
  for (int k = 0; k < 180'000; ++k) {
    const double in_cycle_s = std::fmod(k * kPeriod_s, 60.0);
    speed.push_back(std::max(0.0, 0.5 * std::min(in_cycle_s - 20.0, 60.0 - in_cycle_s)));
  }
  return speed;
}

odometry::SpeedRecord record_of(const OdometerParams& params) {
  odometry::SpeedRecord record{.name = "simulated"};
  record.reference_m_s = drive();
  record.odometer_m_s = shown_speed(record.reference_m_s, kPeriod_s, params);
  for (std::size_t k = 0; k < record.odometer_m_s.size(); ++k) {
    record.time_s.push_back(kPeriod_s * static_cast<double>(k));
  }
  return record;
}

odometry::OdometerFigures figures_of(const OdometerParams& params) {
  return odometry::measure_odometer(record_of(params));
}

TEST(SimulatedOdometer, IdealShowsTheSpeed) {
  const std::vector<double> speed = drive();
  EXPECT_EQ(shown_speed(speed, kPeriod_s, {}), speed);
}

TEST(SimulatedOdometer, CountsMetresPerPulse) {
  const std::vector<double> speed = drive();
  double distance_m = 0.0;
  for (const double v : speed) distance_m += v * kPeriod_s;
  for (const double metres_per_pulse : {0.02, 0.05, 1.9}) {
    const auto pulses = count_pulses(speed, kPeriod_s, {.metres_per_pulse = metres_per_pulse});
    EXPECT_NEAR(static_cast<double>(pulses.back()), distance_m / metres_per_pulse, 1.0);
  }
}

TEST(SimulatedOdometer, IsSilentInItsDeadBandWithHysteresis) {
  const auto figures =
      figures_of({.leaves_zero_at_m_s = 0.9, .silent_below_m_s = 0.6, .holds_s = 0.0});
  EXPECT_NEAR(figures.leaves_zero_m_s.sorted.front(), 0.9, 0.006);
  EXPECT_NEAR(figures.leaves_zero_m_s.sorted.back(), 0.9, 0.006);
  EXPECT_NEAR(figures.reaches_zero_m_s.sorted.front(), 0.6, 0.006);
  EXPECT_NEAR(figures.reaches_zero_m_s.sorted.back(), 0.6, 0.006);
}

TEST(SimulatedOdometer, HoldsItsSmallestSpeed) {
  const OdometerParams params{
      .leaves_zero_at_m_s = 0.75, .silent_below_m_s = 0.75, .holds_s = 2.0, .step_m_s = 0.25};
  const auto figures = figures_of(params);
  EXPECT_NEAR(figures.smallest_m_s.value_or(0.0), 0.75, 1e-9);
  EXPECT_NEAR(figures.holds_s.median.value, 2.0, 0.025);
}

TEST(SimulatedOdometer, IsLateByItsLatency) {
  for (const double late_s : {0.0, 0.1, 0.4}) {
    EXPECT_NEAR(figures_of({.latency_s = late_s}).latency_s.value, late_s, 0.005);
  }
}

TEST(SimulatedOdometer, RoundsToItsStep) {
  EXPECT_NEAR(figures_of({.step_m_s = 0.3}).step_m_s.value_or(0.0), 0.3, 1e-9);
}

// A message stands until the next one, which adds half an interval to the latency.
TEST(SimulatedOdometer, SendsMessagesAtItsRate) {
  for (const double rate_hz : {1.0, 2.5, 5.0, 15.0}) {
    const auto record = record_of({.message_rate_hz = rate_hz});
    int changes = 0;
    int moving = 0;
    for (std::size_t k = 1; k < record.size(); ++k) {
      if (record.reference_m_s[k - 1] == 0.0) continue;
      ++moving;
      changes += record.odometer_m_s[k] != record.odometer_m_s[k - 1] ? 1 : 0;
    }
    EXPECT_NEAR(changes / (moving * kPeriod_s), rate_hz, 0.05 * rate_hz);
    EXPECT_NEAR(odometry::measure_latency(record).value, 0.5 / rate_hz, 0.02) << rate_hz;
  }
}

TEST(SimulatedOdometer, CountsAtThePaceOfItsMessages) {
  const OdometerParams params{.metres_per_pulse = 0.01, .message_rate_hz = 1.0};
  const std::vector<double> speed = drive();
  const auto pulses = count_pulses(speed, kPeriod_s, params);
  for (std::size_t k = 3'100; k < 3'200; k += 10) {  // the message sent at 31 s says 5.5 m/s
    EXPECT_NEAR(static_cast<double>(pulses[k] - pulses[3'099]),
                static_cast<double>(k - 3'099) * 5.5, 1.0);
  }
}

TEST(SimulatedOdometer, OfACarHasTheFiguresOfThePage) {
  const auto figures = figures_of(car_odometer());
  EXPECT_NEAR(figures.smallest_m_s.value_or(0.0), 0.833, 0.001);
  EXPECT_NEAR(figures.step_m_s.value_or(0.0), 0.278, 0.001);
  // At 0.5 m/s2: as a message may be 0.4 s later than the wheel, and is 0.1 s late.
  EXPECT_GE(figures.leaves_zero_m_s.sorted.front(), 0.83);
  EXPECT_LE(figures.leaves_zero_m_s.sorted.back(), 0.83 + 0.5 * 0.52);
  EXPECT_NEAR(figures.holds_s.median.value, 2.8 + 0.3, 0.3);
  EXPECT_NEAR(figures.latency_s.value, 0.1 + 0.2, 0.03);
}

TEST(SimulatedOdometer, RefusesWhatNoOdometerCanHave) {
  const std::vector<double> speed(10, 1.0);
  for (const OdometerParams& params :
       {OdometerParams{.metres_per_pulse = 0.0},
        OdometerParams{.leaves_zero_at_m_s = 0.5, .silent_below_m_s = 0.6},
        OdometerParams{.holds_s = -1.0}, OdometerParams{.latency_s = -0.1},
        OdometerParams{.message_rate_hz = 101.0}, OdometerParams{.step_m_s = -0.1}}) {
    EXPECT_THROW((void)shown_speed(speed, kPeriod_s, params), std::invalid_argument);
  }
}

}  // namespace
}  // namespace zerorate::simulate

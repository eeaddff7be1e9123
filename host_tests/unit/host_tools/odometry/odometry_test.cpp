// Figures of odometers that were made up, so that each figure is known.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/odometry/odometer_figures.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::odometry {
namespace {

using ::testing::HasSubstr;
using Columns = std::function<std::string(double time_s)>;

constexpr double kPeriod_s = 0.1;
constexpr double kCycle_s = 60.0;
constexpr int kCycles = 20;

/// 20 s of rest, 1 m/s2 up to 10 m/s, 10 s of that, 1 m/s2 down to rest, and again.
double speed_at(double time_s) {
  const double in_cycle_s = time_s < 0.0 ? 0.0 : std::fmod(time_s, kCycle_s);
  return std::clamp(std::min(in_cycle_s - 20.0, 50.0 - in_cycle_s), 0.0, 10.0);
}

double rounded(double speed_m_s, double step_m_s) {
  return step_m_s * std::round(speed_m_s / step_m_s);
}

/// A recording of `rows` rows with these columns beside the time.
SpeedRecord record(const std::string& names, int rows, const Columns& columns) {
  std::string text = "t_s," + names + "\n";
  for (int k = 0; k < rows; ++k) {
    const double time_s = k * kPeriod_s;
    text += fmt::format("{:.1f},{}\n", time_s, columns(time_s));
  }
  const zerorate::testing::ScratchFolder folder;
  return read_speed_record(folder.write("drive.csv", text));
}

/// Figures of an odometer's speed as a function of time, on kCycles cycles.
OdometerFigures measure(const std::function<double(double)>& odometer) {
  const int rows = static_cast<int>(kCycles * kCycle_s / kPeriod_s);
  return measure_odometer(record("ref_speed_mps,obd_speed_mps", rows, [&](double time_s) {
    return fmt::format("{},{}", speed_at(time_s), odometer(time_s));
  }));
}

const Rolling& in(Situation situation, const OdometerFigures& figures) {
  return figures.rolling_by_situation[static_cast<std::size_t>(situation)];
}

TEST(OdometerLatency, IsThatOfTheOdometer) {
  for (const double late_s : {-0.2, 0.0, 0.1, 0.37}) {
    const BootstrapFigure latency =
        measure([&](double time_s) { return speed_at(time_s - late_s); }).latency_s;
    EXPECT_NEAR(latency.value, late_s, 0.005);
    EXPECT_LE(latency.lo, latency.value);
    EXPECT_GE(latency.hi, latency.value);
  }
}

TEST(OdometerLatency, BeyondASecondIsNoFigure) {
  EXPECT_TRUE(
      std::isnan(measure([](double time_s) { return speed_at(time_s - 3.0); }).latency_s.value));
}

TEST(OdometerStepAndSmallestSpeed, AreThoseOfTheOdometer) {
  const auto figures = measure([](double time_s) {
    const double shown = rounded(speed_at(time_s), 0.25);
    return shown < 0.75 ? 0.0 : shown;
  });
  EXPECT_NEAR(figures.step_m_s.value_or(0.0), 0.25, 1e-6);
  EXPECT_NEAR(figures.smallest_m_s.value_or(0.0), 0.75, 1e-6);
  // 0.625 m/s rounds to 0.75; speeds of the rows lie 0.1 m/s apart.
  EXPECT_NEAR(figures.leaves_zero_m_s.median.value, 0.625, 0.11);
  EXPECT_NEAR(figures.reaches_zero_m_s.median.value, 0.625, 0.11);
}

TEST(OdometerHold, IsTheTimeFromTheSmallestSpeedUntilZero) {
  constexpr double kHeld_s = 2.5;
  const auto figures = measure([](double time_s) {
    const double shown = rounded(speed_at(time_s), 0.2);
    if (shown >= 0.8) return shown;
    return speed_at(time_s - kHeld_s) >= 0.8 ? 0.8 : 0.0;
  });
  EXPECT_NEAR(figures.holds_s.median.value, kHeld_s, 0.11);
  EXPECT_EQ(figures.holds_s.sorted.size(), std::size_t{kCycles});
}

TEST(OdometerScale, IsOdometerOverReference) {
  EXPECT_NEAR(measure([](double time_s) { return 1.02 * speed_at(time_s); }).scale.value, 1.02,
              1e-4);
}

TEST(RollingAtZero, IsDividedBySituation) {
  // Silent below 1 m/s: a second before each stop and a second after it, less a row of standing.
  const auto figures =
      measure([](double time_s) { return speed_at(time_s) < 1.0 ? 0.0 : speed_at(time_s); });
  const auto rows_a_cycle = [&](Situation situation) {
    return static_cast<double>(in(situation, figures).rows) / kCycles;
  };
  EXPECT_NEAR(rows_a_cycle(Situation::before_stop), 9.0, 1.0);
  EXPECT_NEAR(rows_a_cycle(Situation::after_stop), 9.0, 1.0);
  EXPECT_EQ(rows_a_cycle(Situation::inching), 0.0);
  EXPECT_EQ(rows_a_cycle(Situation::passing), 0.0);
  EXPECT_NEAR(figures.rolling.share.value, 18.0 / 320.0, 0.007);
  EXPECT_LT(figures.rolling.speeds_m_s.back(), 1.0);
  EXPECT_TRUE(figures.rolling.turning_rad_s.empty());
}

TEST(RollingAtZero, BetweenTwoMomentsOfStandingIsInching) {
  const auto figures = measure_odometer(
      record("ref_speed_mps,odometer_speed_mps,ref_rate_dps", 2000, [](double time_s) {
        const double in_cycle_s = std::fmod(time_s + 0.05, 20.0);
        if (in_cycle_s >= 10.0) return "5,5,0";
        return in_cycle_s >= 5.0 && in_cycle_s < 6.0 ? "0.5,0,-4" : "0,0,0";
      }));
  const Rolling& inching = in(Situation::inching, figures);
  EXPECT_EQ(inching.rows, 100U);
  EXPECT_EQ(figures.rolling.rows, inching.rows);
  EXPECT_NEAR(inching.share.value, 0.1, 1e-9);
  EXPECT_NEAR(inching.turning_rad_s.front() * units::kDegPerRad, 4.0, 1e-9);
  EXPECT_NEAR(figures.odometer_stops_s.median.value, 9.9, 0.01);
  EXPECT_NEAR(figures.odometer_drives_s.median.value, 10.1, 0.01);
}

TEST(RollingAtZero, WithoutStandingIsPassing) {
  const auto figures = measure([](double time_s) {  // a dropout at full speed
    return speed_at(time_s) > 9.9 ? 0.0 : speed_at(time_s);
  });
  EXPECT_GT(in(Situation::passing, figures).rows, 95 * std::size_t{kCycles});
}

TEST(OdometerRenewal, IsTheIntervalBetweenNewSpeeds) {
  const auto speed = [](double time_s) { return 10.0 + 8.0 * std::sin(0.4 * time_s); };
  const auto figures =
      measure_odometer(record("ref_speed_mps,odometer_speed_mps", 6000, [&](double time_s) {
        return fmt::format("{},{}", speed(time_s), speed(0.5 * std::floor(2.0 * time_s + 0.01)));
      }));
  EXPECT_NEAR(figures.renewal_s.median.value, 0.5, 1e-6);
}

TEST(OdometerPulses, AreMeasuredByTheDistanceOfTheReference) {
  double metres = 0.0;
  const SpeedRecord drive = record("ref_speed_mps,odometer_pulses", 6000, [&](double time_s) {
    metres += kPeriod_s * speed_at(time_s);
    return fmt::format("{},{}", speed_at(time_s), static_cast<int>(metres / 0.04));
  });
  EXPECT_NEAR(drive.metres_per_pulse, 0.04, 1e-4);
  EXPECT_TRUE(drive.is_silent(100));   // at rest
  EXPECT_FALSE(drive.is_silent(350));  // at 10 m/s
  EXPECT_NEAR(drive.odometer_m_s[350], 10.0, 0.41);
  const auto figures = measure_odometer(drive);
  EXPECT_FALSE(figures.smallest_m_s);
  EXPECT_NEAR(figures.latency_s.value, 0.0, 0.1);
}

TEST(TurningByAGyro, IsWithoutItsBias) {
  const SpeedRecord drive = record("ref_speed_mps,odometer_speed_mps,gz_dps", 2000, [](double t_s) {
    return fmt::format("{},{},{}", speed_at(t_s), speed_at(t_s), 0.3 + speed_at(t_s));
  });
  EXPECT_NEAR(drive.yaw_rad_s[100], 0.0, 1e-12);
  EXPECT_NEAR(drive.yaw_rad_s[350] * units::kDegPerRad, 10.0, 1e-9);
}

TEST(SpeedRecord, CountsLostRowsAndDividesAStopAtAGap) {
  const SpeedRecord drive = record("ref_speed_mps,obd_speed_mps", 400, [](double time_s) {
    const bool is_lost = time_s > 3.95 && time_s < 7.95;
    return is_lost ? "0," : (std::fmod(time_s + 0.05, 20.0) < 10.0 ? "0,0" : "5,5");
  });
  EXPECT_EQ(drive.rows_lost, 40U);
  EXPECT_THAT(drive.gap_before, ::testing::ElementsAre(40U));
  const auto stops = stretches(drive, [&](std::size_t row) { return drive.stands(row); });
  ASSERT_EQ(stops.size(), 3U);
  EXPECT_FALSE(stops[0].has_begin);
  EXPECT_FALSE(stops[0].has_end);
  EXPECT_FALSE(stops[1].has_begin);
  EXPECT_TRUE(stops[1].has_end);
  EXPECT_TRUE(stops[2].is_whole());
}

/// The message of the error that a file gives.
std::string complaint(const std::string& text) {
  const zerorate::testing::ScratchFolder folder;
  try {
    (void)read_speed_record(folder.write("bad.csv", text));
  } catch (const recording::DataError& error) {
    return error.what();
  }
  return "";
}

TEST(SpeedRecord, NamesWhatIsMissingOrWrong) {
  EXPECT_THAT(complaint("t_s,obd_speed_mps\n0,1\n"), HasSubstr("ref_speed_mps"));
  EXPECT_THAT(complaint("t_s,ref_speed_mps\n0,1\n"), HasSubstr("odometer_pulses"));
  EXPECT_THAT(complaint("ref_speed_mps,obd_speed_mps\n0,1\n"), HasSubstr("t_s"));
  const std::string header = "t_s,ref_speed_mps,obd_speed_mps\n";
  EXPECT_THAT(complaint(header + "0,1,fast\n"), HasSubstr(":2:5: found \"fast\""));
  EXPECT_THAT(complaint(header + "0,1\n"), HasSubstr("2 fields"));
  EXPECT_THAT(complaint(header + "1,1,1\n1,1,1\n"), HasSubstr("not later"));
  EXPECT_THAT(complaint(header + "1,1,1\n"), HasSubstr("hundred rows"));
  EXPECT_THAT(complaint("# nothing\n"), HasSubstr("an empty file"));
}

TEST(OdometerJson, HoldsTheFigures) {
  const SpeedRecord drive = record("ref_speed_mps,obd_speed_mps", 6000, [](double time_s) {
    const double shown = rounded(speed_at(time_s), 0.25);
    return fmt::format("{},{}", speed_at(time_s), shown < 0.75 ? 0.0 : shown);
  });
  const auto json = nlohmann::json::parse(to_json(drive, measure_odometer(drive)));
  EXPECT_EQ(json["schema"], "zerorate.odometer/1");
  EXPECT_EQ(json["recording"], "drive.csv");
  EXPECT_NEAR(json["smallest_mps"].get<double>(), 0.75, 1e-6);
  EXPECT_TRUE(json["metres_per_pulse"].is_null());
  EXPECT_EQ(json["leaves_zero_mps"]["count"], 10);
  EXPECT_EQ(json["leaves_zero_mps"]["quantiles"].size(), 21U);
  EXPECT_EQ(json["rolling_by_situation"].size(), 4U);
}

}  // namespace
}  // namespace zerorate::odometry

// Faults of an odometer that were hidden in made-up drives, and a healthy one.

#include "host_tools/lib/odometry/odometer_findings.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"

namespace zerorate::odometry {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kPeriod_s = 0.1;
constexpr double kPulse_m = 0.05;

/// Faults to hide; the defaults are those of a healthy odometer.
struct Hidden {
  double dead_band_m_s = 0.0;
  double late_s = 0.0;
  double doubled_from_s = 1e9;  ///< for 120 s
  double dead_from_s = 1e9;     ///< for 60 s
  bool inches = false;          ///< creeps forward by a metre within every other stop
};

/// Speeds of an hour in town, row by row: stops and drives of random length, 0.7 to 1.5 m/s2.
std::vector<double> speeds_in_town(std::uint64_t seed, bool inches) {
  std::mt19937_64 random{seed};
  const auto between = [&](double least, double most) {
    return std::uniform_real_distribution<double>{least, most}(random);
  };
  std::vector<double> speeds;
  const auto change_to = [&](double target_m_s, double by_m_s2) {
    while (std::abs(speeds.back() - target_m_s) > 1e-9) {
      const double step = by_m_s2 * kPeriod_s;
      speeds.push_back(speeds.back() + std::clamp(target_m_s - speeds.back(), -step, step));
    }
  };
  const auto hold = [&](double length_s) {
    speeds.insert(speeds.end(), static_cast<std::size_t>(length_s / kPeriod_s), speeds.back());
  };
  speeds.push_back(0.0);
  for (int stop = 0; static_cast<double>(speeds.size()) * kPeriod_s < 3600.0; ++stop) {
    hold(between(5.0, 20.0));
    if (inches && stop % 2 == 1) {
      change_to(0.5, 0.5);
      hold(1.5);
      change_to(0.0, 0.5);
      hold(between(3.0, 10.0));
    }
    const double acceleration_m_s2 = between(0.7, 1.5);
    change_to(between(6.0, 14.0), acceleration_m_s2);
    hold(between(10.0, 60.0));
    change_to(0.0, between(0.7, 1.5));
  }
  return speeds;
}

/// Metres by the odometer, counted in pulses.
std::vector<double> pulses_of(const std::vector<double>& speeds, const Hidden& hidden) {
  std::vector<double> metres(speeds.size(), 0.0);
  for (std::size_t row = 1; row < speeds.size(); ++row) {
    const double time_s = static_cast<double>(row) * kPeriod_s;
    const bool is_dead = time_s >= hidden.dead_from_s && time_s < hidden.dead_from_s + 60.0;
    const bool is_doubled =
        time_s >= hidden.doubled_from_s && time_s < hidden.doubled_from_s + 120.0;
    const double speed = speeds[row] < hidden.dead_band_m_s || is_dead ? 0.0 : speeds[row];
    metres[row] = metres[row - 1] + (is_doubled ? 2.0 : 1.0) * speed * kPeriod_s;
  }
  const auto late = static_cast<std::size_t>(std::lround(hidden.late_s / kPeriod_s));
  std::vector<double> pulses(speeds.size(), 0.0);
  for (std::size_t row = late; row < speeds.size(); ++row) {
    pulses[row] = std::floor(metres[row - late] / kPulse_m);
  }
  return pulses;
}

std::vector<std::string> names_of(const Hidden& hidden, std::uint64_t seed) {
  const std::vector<double> speeds = speeds_in_town(seed, hidden.inches);
  const std::vector<double> pulses = pulses_of(speeds, hidden);
  std::mt19937_64 random{seed + 1000};
  std::normal_distribution<double> noise{0.0, 0.01};
  std::string text = "t_s,ref_speed_mps,odometer_pulses,ref_rate_dps\n";
  for (std::size_t row = 0; row < speeds.size(); ++row) {
    text += fmt::format("{:.1f},{:.4f},{},{:.3f}\n", static_cast<double>(row) * kPeriod_s,
                        std::abs(speeds[row] + noise(random)), pulses[row], 0.5 * speeds[row]);
  }
  const zerorate::testing::ScratchFolder folder;
  const SpeedRecord record = read_speed_record(folder.write("drive.csv", text));
  std::vector<std::string> names;
  for (const OdometerFinding& finding : find_odometer_faults(record, measure_odometer(record))) {
    EXPECT_FALSE(finding.sentence.empty());
    EXPECT_FALSE(finding.figures.empty());
    names.push_back(finding.name);
  }
  return names;
}

TEST(HealthyOdometer, HasNoFaultOnAnyOfTenDrives) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) EXPECT_THAT(names_of({}, seed), IsEmpty());
}

TEST(DeadBand, IsFoundOnEveryDriveWithItsMotion) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const double band_m_s : {0.5, 0.83}) {
      EXPECT_THAT(names_of({.dead_band_m_s = band_m_s}, seed),
                  ElementsAre("motion_in_stops", "odometer_dead_band"))
          << band_m_s;
    }
  }
}

TEST(InchingBelowADeadBand, IsFoundAsMotion) {
  EXPECT_THAT(names_of({.dead_band_m_s = 0.83, .inches = true}, 3),
              ElementsAre("motion_in_stops", "odometer_dead_band"));
  EXPECT_THAT(names_of({.inches = true}, 3), IsEmpty()) << "the pulses tell of it";
}

TEST(LateMessages, AreFoundAndNotTakenForADeadBand) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto names = names_of({.late_s = 0.5}, seed);
    EXPECT_THAT(names, ::testing::Contains("odometer_late"));
    EXPECT_THAT(names, ::testing::Not(::testing::Contains("odometer_dead_band")));
  }
}

TEST(DoubleCounting, IsFound) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_THAT(names_of({.doubled_from_s = 1500.0}, seed),
                ElementsAre("odometer_double_counting"));
  }
}

TEST(DyingSensor, IsFoundAndNotTakenForADeadBand) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_THAT(names_of({.dead_from_s = 2000.0}, seed), ElementsAre("odometer_silent"));
  }
}

TEST(SeveralFaults, AreFoundTogether) {
  EXPECT_THAT(
      names_of({.dead_band_m_s = 0.83, .late_s = 0.3, .dead_from_s = 2000.0}, 7),
      ElementsAre("motion_in_stops", "odometer_dead_band", "odometer_late", "odometer_silent"));
}

}  // namespace
}  // namespace zerorate::odometry

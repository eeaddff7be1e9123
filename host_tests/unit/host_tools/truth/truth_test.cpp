#include "host_tools/lib/truth/truth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/truth/delayed.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::truth {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr std::int64_t kSecond = 1'000'000'000;

/// Speed, rate about the vertical and heading of a made-up vehicle, as functions of time in
/// seconds.
struct Vehicle {
  double speed_m_s;
  double rate_dps;
  double heading_deg;
};

/// Stands for 20 s, drives for 40 s, and so on; each drive turns by 90 deg within 20 s.
Vehicle in_town(double time_s) {
  const double phase = std::fmod(time_s, 60.0);
  const double drives = std::floor(time_s / 60.0);
  if (phase < 20.0) return {0.0, 0.0, 90.0 * drives};
  const double turned = std::clamp((phase - 30.0) / 20.0, 0.0, 1.0);
  return {std::min(phase - 20.0, 60.0 - phase), turned > 0.0 && turned < 1.0 ? 4.5 : 0.0,
          90.0 * (drives + turned)};
}

struct Made {
  double length_s = 300.0;
  double period_s = 0.1;
  double speed_noise_m_s = 0.005;
  std::size_t axis = 2;
  float sign = 1.0F;
  recording::Columns columns{.odometer = true, .ref_heading = true, .ref_speed = true};
  std::function<void(double, recording::Row&)> spoil = [](double, recording::Row&) {};
};

class ReferenceOfADrive : public ::testing::Test {
 protected:
  Track track(const Made& made) {
    const auto path = folder_.path() / "drive.csv";
    recording::Writer writer{path, made.columns};
    std::mt19937_64 random{11};
    std::normal_distribution<double> normal;
    const auto rows = static_cast<int>(made.length_s / made.period_s) + 1;
    for (int k = 0; k < rows; ++k) {
      const double time_s = made.period_s * k;
      const Vehicle vehicle = in_town(time_s);
      recording::Row row{.time_ns = std::llround(time_s * 1e9)};
      for (float& rate : row.rate_rad_s) {
        rate = static_cast<float>(0.01 * kRadPerDeg * normal(random));
      }
      row.rate_rad_s[made.axis] += made.sign * static_cast<float>(vehicle.rate_dps * kRadPerDeg);
      row.ref_heading_rad =
          static_cast<float>(std::fmod(vehicle.heading_deg + 300.0, 360.0) * kRadPerDeg);
      row.ref_rate_rad_s = static_cast<float>(vehicle.rate_dps * kRadPerDeg);
      row.ref_speed_m_s =
          static_cast<float>(vehicle.speed_m_s + made.speed_noise_m_s * normal(random));
      made.spoil(time_s, row);
      writer.write(row);
    }
    writer.finish();
    recording::Reader reader{path};
    return read_track(reader);
  }
  Truth truth(const Made& made, const TruthOptions& options = {}) {
    return find_truth(track(made), options);
  }

  zerorate::testing::ScratchFolder folder_;
};

TEST_F(ReferenceOfADrive, GivesStopsMiddlesAndTurns) {
  const Truth found = truth({});
  EXPECT_EQ(found.obstacle, "");
  ASSERT_EQ(found.stops.size(), 5U) << "the sixth lasts a single sample";
  ASSERT_EQ(found.drives.size(), 4U);
  for (std::size_t k = 0; k < found.drives.size(); ++k) {
    const auto begin = static_cast<double>(60 * k);
    const Drive& drive = found.drives[k];
    // The speed passes the limit of 0.03 m/s within a sample of standing.
    EXPECT_NEAR(static_cast<double>(drive.from_ns) * 1e-9, begin + 10.0, 0.11);
    EXPECT_NEAR(static_cast<double>(drive.departure_ns) * 1e-9, begin + 20.0, 0.11);
    EXPECT_NEAR(static_cast<double>(drive.to_ns) * 1e-9, begin + 70.0, 0.11);
    EXPECT_NEAR(drive.turn_rad / kRadPerDeg, 90.0, 1e-3) << "over the wrap at 360 deg";
    EXPECT_EQ(drive.flaw, Flaw::none);
  }
  EXPECT_EQ(name(found.vertical, 3), "z");
  EXPECT_NEAR(found.error_at_stops_rad, 0.0, 1e-6);
}

TEST_F(ReferenceOfADrive, GivesWholeTurnsWithoutItsDelay) {
  constexpr double kDelay_s = 13.0;
  const auto late = [](double time_s, recording::Row& row) {
    const double heading_deg = in_town(std::max(0.0, time_s - kDelay_s)).heading_deg;
    row.ref_heading_rad = static_cast<float>(std::fmod(heading_deg + 300.0, 360.0) * kRadPerDeg);
  };
  const Track delayed = track({.spoil = late});
  const Truth as_it_is = find_truth(delayed, {.vertical = VerticalAxis{}});
  const Truth mended = without_delay(as_it_is, delayed, 13 * kSecond);
  EXPECT_GT(as_it_is.error_at_stops_rad, 1.0 * kRadPerDeg);
  EXPECT_NEAR(mended.error_at_stops_rad, 0.0, 1e-6);
  EXPECT_EQ(mended.reference_error_rad, mended.error_at_stops_rad);
  ASSERT_EQ(mended.drives.size(), as_it_is.drives.size());
  EXPECT_LT(as_it_is.drives[0].way_turn_rad / kRadPerDeg, 89.0);
  EXPECT_NEAR(mended.drives[0].way_turn_rad / kRadPerDeg, 90.0, 1e-3);
}

/// Headings at each n-th stop alone, beside a bias of 0.5 deg/s and a scale factor of 1.01.
std::function<void(double, recording::Row&)> headings_at_each(int n, float heading_rad) {
  return [=](double time_s, recording::Row& row) {
    const bool is_parked =
        static_cast<int>(time_s / 60.0) % n == 0 && std::fmod(time_s, 60.0) < 20.0;
    row.ref_heading_rad = is_parked ? heading_rad : std::numeric_limits<float>::quiet_NaN();
    row.rate_rad_s[2] = 1.01F * row.rate_rad_s[2] + 0.5F * static_cast<float>(kRadPerDeg);
  };
}

TEST_F(ReferenceOfADrive, MayHaveHeadingsAtStopsOnly) {
  const Truth found = truth({.spoil = [](double time_s, recording::Row& row) {
    const bool stands = std::fmod(time_s, 60.0) < 20.0;
    if (!stands) row.ref_heading_rad = std::numeric_limits<float>::quiet_NaN();
    row.rate_rad_s[2] += 0.5F * static_cast<float>(kRadPerDeg);
  }});
  EXPECT_TRUE(found.has_headings_at_stops_only);
  EXPECT_EQ(name(found.vertical, 3), "z");
  ASSERT_EQ(found.drives.size(), 4U);
  for (const Drive& drive : found.drives) {
    EXPECT_EQ(drive.flaw, Flaw::none);
    EXPECT_NEAR(drive.turn_rad / kRadPerDeg, 90.0, 1e-3);
    EXPECT_NEAR(drive.way_turn_rad / kRadPerDeg, 90.0, 1e-3);
  }
}

TEST_F(ReferenceOfADrive, MayBeOnePlaceWhereTheVehicleParks) {
  const Truth found = truth({.length_s = 1'000.0, .spoil = headings_at_each(4, 0.3F)});
  EXPECT_TRUE(found.has_headings_at_stops_only);
  ASSERT_EQ(found.drives.size(), 4U);
  for (const Drive& drive : found.drives) {
    EXPECT_EQ(drive.flaw, Flaw::none);
    EXPECT_NEAR(drive.turn_rad / kRadPerDeg, 360.0, 1e-3) << "counted by the gyro";
  }
}

TEST_F(ReferenceOfADrive, HasTheSenseThatFitsTheHeadingsAtStops) {
  const auto spoil = [](double time_s, recording::Row& row) {
    const bool stands = std::fmod(time_s, 60.0) < 20.0;
    if (!stands) row.ref_heading_rad = std::numeric_limits<float>::quiet_NaN();
  };
  EXPECT_EQ(name(truth({.axis = 0, .sign = -1.0F, .spoil = spoil}).vertical, 3), "-x");
  EXPECT_EQ(name(truth({.axis = 1, .spoil = spoil}).vertical, 3), "y");
}

TEST_F(ReferenceOfADrive, HasALimitOfStandingThatFollowsItsNoise) {
  const Truth calm = truth({.speed_noise_m_s = 0.0});
  EXPECT_EQ(calm.speed_limit_m_s, 0.02);
  // The size of normal noise: a span of 20 samples has this rms within 1 / sqrt(40) = 16 %, and
  // the lower quartile of the spans lies 0.67 of that below.
  const Truth noisy = truth({.speed_noise_m_s = 0.02});
  EXPECT_NEAR(noisy.speed_noise_m_s, 0.02 * (1.0 - 0.67 * 0.16), 0.002);
  EXPECT_NEAR(noisy.speed_limit_m_s, 6.0 * noisy.speed_noise_m_s, 1e-12);
  EXPECT_EQ(noisy.stops.size(), 5U);
}

TEST_F(ReferenceOfADrive, TellsTheVerticalAxisAndItsSense) {
  EXPECT_EQ(name(truth({.axis = 0, .sign = -1.0F}).vertical, 3), "-x");
  EXPECT_EQ(name(truth({.axis = 1}).vertical, 3), "y");
  const Truth named = truth({.axis = 1}, {.vertical = parse_vertical_axis("-z")});
  EXPECT_EQ(name(named.vertical, 3), "-z") << "the user's word counts";
}

TEST_F(ReferenceOfADrive, IsRefusedWhereNoAxisFollowsIt) {
  const auto tilted = [](double, recording::Row& row) {
    row.rate_rad_s[2] *= 0.7071F;
    row.rate_rad_s[0] += row.rate_rad_s[2];
  };
  try {
    static_cast<void>(truth({.spoil = tilted}));
    FAIL() << "45 deg of tilt are no vertical axis";
  } catch (const recording::DataError& error) {
    EXPECT_NE(std::string(error.what()).find("--vertical-axis"), std::string::npos);
  }
  EXPECT_THROW(static_cast<void>(truth({.sign = 0.0F})), recording::DataError);
  EXPECT_NO_THROW(static_cast<void>(truth({.spoil = tilted}, {.vertical = VerticalAxis{}})));
}

TEST_F(ReferenceOfADrive, MayComeAsARate) {
  Made made;
  made.columns.ref_heading = false;
  made.columns.ref_rate = true;
  const Truth found = truth(made);
  ASSERT_EQ(found.drives.size(), 4U);
  // 4.5 deg/s for 20 s by the trapezoidal rule: each edge is known to a sample.
  for (const Drive& drive : found.drives) {
    EXPECT_NEAR(drive.turn_rad / kRadPerDeg, 90.0, 4.5 * 0.1);
  }
}

TEST_F(ReferenceOfADrive, MayBeSlowerThanTheGyro) {
  const auto every_second = [](double time_s, recording::Row& row) {
    if (std::abs(std::remainder(time_s, 1.0)) < 0.01) return;
    row.ref_heading_rad = std::nanf("");
    row.ref_speed_m_s = std::nanf("");
  };
  const Truth found = truth({.spoil = every_second});
  ASSERT_EQ(found.drives.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(found.drives[k].turn_rad / kRadPerDeg, 90.0, 1e-3);
    EXPECT_NEAR(static_cast<double>(found.drives[k].departure_ns) * 1e-9,
                static_cast<double>(60 * k) + 20.0, 1.01);
  }
}

TEST_F(ReferenceOfADrive, MayBeAMarkAtStopsBetweenWholeTurns) {
  // Each drive turns by 450 deg, and a mark shows 90 deg.
  const auto spins = [](double time_s, recording::Row& row) {
    const double phase = std::fmod(time_s, 60.0);
    if (phase > 30.0 && phase < 50.0) row.rate_rad_s[2] += static_cast<float>(18.0 * kRadPerDeg);
    if (std::abs(phase - 9.9) > 0.04) row.ref_heading_rad = std::nanf("");
  };
  const Truth found = truth({.spoil = spins}, {.vertical = VerticalAxis{}});
  ASSERT_EQ(found.drives.size(), 4U);
  // The last drive has no mark after it.
  for (std::size_t k = 0; k < 3; ++k) {
    // The middle of a stop lies within 0.2 s of its mark, a minute from the next one.
    EXPECT_NEAR(found.drives[k].turn_rad / kRadPerDeg, 450.0, 450.0 * 0.4 / 60.0);
    EXPECT_EQ(found.drives[k].flaw, Flaw::none);
  }
}

TEST_F(ReferenceOfADrive, FlagsDrivesWithGapsAndJumps) {
  const auto spoilt = [](double time_s, recording::Row& row) {
    if (time_s > 100.0 && time_s < 105.0) row.ref_heading_rad = std::nanf("");
    if (time_s > 155.0) row.ref_heading_rad += static_cast<float>(40.0 * kRadPerDeg);
  };
  const Truth found = truth({.spoil = spoilt});
  ASSERT_EQ(found.drives.size(), 4U);
  EXPECT_EQ(found.drives[0].flaw, Flaw::none);
  EXPECT_EQ(found.drives[1].flaw, Flaw::heading_missing);
  EXPECT_EQ(found.drives[2].flaw, Flaw::heading_jump);
  EXPECT_EQ(found.drives[3].flaw, Flaw::none);
}

/// Repeats its rates from a time on, as long as it stays within a span.
std::function<void(double, recording::Row&)> stuck(double from_s, double to_s) {
  return [=, held = std::array<float, 3>{}](double time_s, recording::Row& row) mutable {
    if (time_s > from_s && time_s < to_s) {
      row.rate_rad_s = held;
    } else {
      held = row.rate_rad_s;
    }
  };
}

TEST_F(ReferenceOfADrive, IsNotAtFaultWhereTheGyroIsStuck) {
  const Truth found = truth({.spoil = stuck(85.0, 130.0)});
  ASSERT_EQ(found.drives.size(), 4U);
  for (const Drive& drive : found.drives) EXPECT_EQ(drive.flaw, Flaw::none);
  EXPECT_NEAR(found.drives[1].turn_rad / kRadPerDeg, 90.0, 1e-3);
  EXPECT_EQ(name(truth({.spoil = stuck(100.0, 301.0)}).vertical, 3), "z") << "dead for good";
}

TEST_F(ReferenceOfADrive, IsNotAtFaultWhereTheGyroHasWildValues) {
  // One value of 200 is 300 deg/s, which is 30 deg: the turns of the drives are 4.5 deg/s.
  const auto wild = [](double time_s, recording::Row& row) {
    const auto k = std::lround(time_s * 10.0);
    if (k % 200 == 77)
      row.rate_rad_s[2] = static_cast<float>(300.0 * kRadPerDeg * static_cast<double>(k % 3 - 1));
  };
  const Truth found = truth({.spoil = wild});
  EXPECT_EQ(name(found.vertical, 3), "z");
  EXPECT_NEAR(found.vertical.turns_ratio, 1.0, 0.02);
  ASSERT_EQ(found.drives.size(), 4U);
  for (const Drive& drive : found.drives) EXPECT_EQ(drive.flaw, Flaw::none);
}

TEST_F(ReferenceOfADrive, GivesTheAxisOfAGyroThatClipsSomeTurns) {
  // A spin of 200 deg/s for 2 s in one drive, of which the gyro measures 30 deg/s at most.
  const auto clips = [](double time_s, recording::Row& row) {
    constexpr double kSpin_dps = 200.0;
    const double spun_s = std::clamp(time_s - 95.0, 0.0, 2.0);
    if (spun_s > 0.0 && spun_s < 2.0) row.rate_rad_s[2] = static_cast<float>(30.0 * kRadPerDeg);
    const double heading_deg = double{row.ref_heading_rad} / kRadPerDeg + kSpin_dps * spun_s;
    row.ref_heading_rad = static_cast<float>(std::fmod(heading_deg, 360.0) * kRadPerDeg);
  };
  const Truth found = truth({.length_s = 900.0, .spoil = clips});
  EXPECT_EQ(name(found.vertical, 3), "z");
  EXPECT_NEAR(found.vertical.turns_ratio, 1.0, 0.02);
}

TEST_F(ReferenceOfADrive, TurnsOnTheWayAsFromMiddleToMiddle) {
  const Truth found = truth({});
  ASSERT_EQ(found.drives.size(), 4U);
  for (const Drive& drive : found.drives) {
    EXPECT_NEAR(drive.way_turn_rad, drive.turn_rad, 1e-5);
    EXPECT_NEAR(units::seconds(drive.departure_ns - drive.way_from_ns()), 2.0, 1e-9);
    EXPECT_NEAR(units::seconds(drive.way_to_ns() - drive.arrival_ns), 2.0, 1e-9);
  }
}

TEST_F(ReferenceOfADrive, ThatEndsEarlyLeavesTheRestUnscored) {
  const auto ends = [](double time_s, recording::Row& row) {
    if (time_s > 170.0) row.ref_heading_rad = std::nanf("");
  };
  const Truth found = truth({.spoil = ends});
  ASSERT_EQ(found.drives.size(), 4U);
  EXPECT_EQ(found.drives[1].flaw, Flaw::none);
  EXPECT_EQ(found.drives[2].flaw, Flaw::heading_missing);
  EXPECT_EQ(found.drives[3].flaw, Flaw::heading_missing);
}

TEST_F(ReferenceOfADrive, SaysWhatIsMissing) {
  const auto moves = [](double, recording::Row& row) { row.ref_speed_m_s += 3.0F; };
  const Truth never_stops = truth({.spoil = moves});
  EXPECT_EQ(never_stops.stops.size(), 0U);
  EXPECT_NE(never_stops.obstacle.find("0 stops"), std::string::npos) << never_stops.obstacle;
  EXPECT_EQ(truth({.length_s = 50.0}).stops.size(), 1U);
  EXPECT_NE(truth({.length_s = 50.0}).obstacle.find("1 stop "), std::string::npos);

  Made no_speed;
  no_speed.columns.ref_speed = false;
  EXPECT_NE(truth(no_speed).obstacle.find("ref_speed_mps"), std::string::npos);
  Made no_heading;
  no_heading.columns.ref_heading = false;
  EXPECT_NE(truth(no_heading).obstacle.find("ref_heading_deg"), std::string::npos);

  const auto straight = [](double, recording::Row& row) { row.ref_heading_rad = 1.0F; };
  EXPECT_NE(truth({.spoil = straight}).obstacle.find("--vertical-axis"), std::string::npos);
  const auto lost = [](double, recording::Row& row) { row.ref_speed_m_s = std::nanf(""); };
  EXPECT_NE(truth({.spoil = lost}).obstacle.find("ref_speed_mps"), std::string::npos);
}

TEST_F(ReferenceOfADrive, KnowsItsOwnErrorFromTheStops) {
  // It drifts by 0.01 deg/s: by 0.2 deg over a stop of 20 s.
  const auto drifts = [](double time_s, recording::Row& row) {
    row.ref_heading_rad += static_cast<float>(0.01 * kRadPerDeg * time_s);
  };
  const Truth found = truth({.spoil = drifts});
  EXPECT_NEAR(found.error_at_stops_rad / kRadPerDeg, 0.2, 0.005);
  EXPECT_EQ(found.reference_error_rad, found.error_at_stops_rad);
  const Truth told = truth({.spoil = drifts}, {.reference_error_rad = 0.5});
  EXPECT_EQ(told.reference_error_rad, 0.5);
}

TEST_F(ReferenceOfADrive, IsLeftOutWhileItAligns) {
  const Truth found = truth({}, {.usable_from_s = 70.0});
  EXPECT_EQ(found.stops.size(), 4U);
  EXPECT_NEAR(static_cast<double>(found.drives.front().departure_ns) / kSecond, 80.0, 0.11);
}

TEST(VerticalAxisAsTyped, IsReadOrRefused) {
  EXPECT_EQ(parse_vertical_axis("x").axis, 0U);
  EXPECT_EQ(parse_vertical_axis("-y").sign, -1.0);
  EXPECT_EQ(parse_vertical_axis("+z").sign, 1.0);
  for (const char* wrong : {"", "-", "w", "zz", "--z"}) {
    EXPECT_THROW(static_cast<void>(parse_vertical_axis(wrong)), std::invalid_argument) << wrong;
  }
}

}  // namespace
}  // namespace zerorate::truth

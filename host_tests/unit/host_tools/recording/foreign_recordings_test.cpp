#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <iostream>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/number.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr float kDegree = 0.017453292519943295F;

/// Reads files with what a user says of them.
class ForeignFile : public ::testing::Test {
 protected:
  std::vector<Row> read(std::string_view text) {
    input_.path = folder_.write("log.csv", text);
    Reader reader{input_};
    columns_ = reader.columns();
    std::vector<Row> rows;
    for (Row row; reader.next(row);) rows.push_back(row);
    return rows;
  }

  std::string complaint(std::string_view text) {
    try {
      static_cast<void>(read(text));
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  }

  zerorate::testing::ScratchFolder folder_;
  Input input_;
  Columns columns_;
};

class NamedColumns : public ForeignFile {};

TEST_F(NamedColumns, AreReadInTheirUnits) {
  input_.layout.set_columns("t=stamp,gx=wx,gy=wy,gz=wz,temp=T");
  input_.layout.set_units("time=ms,rate=dph,temp=k");
  const auto rows = read("stamp,wx,wy,wz,T,other\n1000.5,3600,-7200,0,300.15,x\n");
  ASSERT_EQ(rows.size(), 1);
  EXPECT_EQ(rows[0].time_ns, 1'000'500'000);
  EXPECT_FLOAT_EQ(rows[0].rate_rad_s[0], kDegree);
  EXPECT_FLOAT_EQ(rows[0].rate_rad_s[1], -2.0F * kDegree);
  EXPECT_FLOAT_EQ(rows[0].temperature_degc, 27.0F);
}

TEST_F(NamedColumns, HoldAccelerationsOfAllAxes) {
  input_.layout.set_columns("ax=a,ay=b,az=c");
  input_.layout.set_units("acceleration=0.001g");
  const auto rows = read("t_s,rate_dps,a,b,c\n0,0,1000,-500,0\n");
  EXPECT_THAT(rows[0].acceleration_m_s2, ElementsAre(9.80665F, -4.903325F, 0.0F));
  EXPECT_THAT(complaint("t_s,rate_dps,a,b\n0,0,1000,-500\n"), HasSubstr("no column \"c\""));
  input_.layout.columns.erase("az");
  EXPECT_THAT(complaint("t_s,rate_dps,a,b,c\n0,0,1000,-500,0\n"), HasSubstr("not all three axes"));
}

TEST_F(NamedColumns, MayHoldRawCounts) {
  input_.layout.set_columns("t=#1,rate=#3");
  input_.layout.set_units("time=us,rate=0.00875dps");
  const auto rows = read("t,a,raw\n7,x,-1000\n");
  EXPECT_EQ(rows[0].time_ns, 7'000);
  EXPECT_FLOAT_EQ(rows[0].rate_rad_s[0], -8.75F * kDegree);
}

TEST_F(NamedColumns, TakeThePlaceOfThoseWithANameOfTheFormat) {
  input_.layout.set_columns("rate=better");
  input_.layout.set_units("rate=dps");
  const auto rows = read("t_s,rate_dps,better\n0,1,2\n");
  EXPECT_FLOAT_EQ(rows[0].rate_rad_s[0], 2.0F * kDegree);
}

TEST_F(NamedColumns, MustBeThere) {
  input_.layout.set_columns("t=stamp");
  EXPECT_THAT(complaint("t_s,rate_dps\n0,1\n"), HasSubstr("no column \"stamp\""));
}

TEST_F(NamedColumns, NeedAUnit) {
  input_.layout.set_columns("rate=wz");
  EXPECT_THAT(complaint("t_s,wz\n0,1\n"),
              HasSubstr("log.csv:1:5: found no unit in the name \"wz\""));
}

TEST_F(NamedColumns, AreNotGuessedFromAUnitAlone) {
  input_.layout.set_units("rate=radps");
  EXPECT_THAT(complaint("t_s,rate_dps\n0,1\n"), HasSubstr("no column that needs --units rate"));
}

class FileWithoutAHeader : public ForeignFile {};

TEST_F(FileWithoutAHeader, IsReadByNumbersOfColumns) {
  input_.layout.set_columns("t=#1,gx=#2,gy=#3,gz=#4");
  input_.layout.set_units("time=s,rate=radps");
  const auto rows = read("0.5,1,2,3\n1.5,4,5,6\n");
  ASSERT_EQ(rows.size(), 2);
  EXPECT_EQ(rows[0].time_ns, 500'000'000);
  EXPECT_THAT(rows[1].rate_rad_s, ElementsAre(4.0F, 5.0F, 6.0F));
}

TEST_F(FileWithoutAHeader, SaysHowToReadItOtherwise) {
  EXPECT_THAT(complaint("0,1,2,3\n"), HasSubstr("--columns t=#1"));
}

class Delimiter : public ForeignFile {};

TEST_F(Delimiter, IsFoundInTheHeader) {
  EXPECT_FLOAT_EQ(read("t_s;rate_radps\n0;0.5\n")[0].rate_rad_s[0], 0.5F);
  EXPECT_FLOAT_EQ(read("t_s\trate_radps\n0\t0.5\n")[0].rate_rad_s[0], 0.5F);
}

TEST_F(Delimiter, MayStandBesideDecimalCommas) {
  input_.layout.decimal_comma = true;
  const auto rows = read("t_s;rate_radps\n0,25;-0,5\n");
  EXPECT_EQ(rows[0].time_ns, 250'000'000);
  EXPECT_FLOAT_EQ(rows[0].rate_rad_s[0], -0.5F);
  EXPECT_THAT(complaint("t_s,rate_radps\n0,5\n"), HasSubstr("another delimiter"));
}

TEST_F(Delimiter, MayBeAnyNumberOfSpaces) {
  input_.layout.set_delimiter("space");
  const auto rows = read("t_s  gx_radps gy_radps   gz_radps \n 0   1  2 3  \n");
  EXPECT_THAT(rows[0].rate_rad_s, ElementsAre(1.0F, 2.0F, 3.0F));
}

TEST_F(Delimiter, LeavesEmptyCellsBetweenTabsEmpty) {
  const auto rows = read("t_s\tgx_radps\tgy_radps\tgz_radps\n0\t\t2\t3\n");
  EXPECT_TRUE(std::isnan(rows[0].rate_rad_s[0]));
  EXPECT_FLOAT_EQ(rows[0].rate_rad_s[1], 2.0F);
}

class FolderOfEuroc : public ForeignFile {};

TEST_F(FolderOfEuroc, IsReadByItsHeaderInAComment) {
  std::filesystem::create_directories(folder_.path() / "mav0/imu0");
  static_cast<void>(folder_.write(
      "mav0/imu0/data.csv",
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m "
      "s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
      "1403636579758555392,-0.099134701513277898,0.14730578886832138,0.02722713633111154,8.1,-0."
      "375,-2.5\n"));
  Reader reader{Input{folder_.path()}};
  Row row;
  ASSERT_TRUE(reader.next(row));
  EXPECT_EQ(row.time_ns, 1'403'636'579'758'555'392);
  EXPECT_FLOAT_EQ(row.rate_rad_s[1], 0.14730578886832138F);
  EXPECT_THAT(row.acceleration_m_s2, ElementsAre(8.1F, -0.375F, -2.5F));
}

TEST(CalendarTime, CountsFrom1970) {
  EXPECT_EQ(parse_calendar_time("1970-01-01T00:00:00Z"), 0);
  EXPECT_EQ(parse_calendar_time("2026-03-01T12:30:00.25Z"), 1'772'368'200'250'000'000);
  EXPECT_EQ(parse_calendar_time("2026-03-01 13:30:00.25+01:00"), 1'772'368'200'250'000'000);
  EXPECT_EQ(parse_calendar_time("2024-02-29T00:00:00"), 1'709'164'800'000'000'000);
}

TEST(CalendarTime, IsNothingElse) {
  for (const char* text : {"", "2026-02-29T00:00:00Z", "2026-03-01", "2026-03-01T24:00:00Z",
                           "2026-03-01T12:30:61Z", "2026-03-01T12:30:0Z", "2026-03-01T12:30:00X",
                           "2026-3-1T12:30:00Z", "9999-01-01T00:00:00Z", "2026-03-01T12:30:-5Z"}) {
    EXPECT_EQ(parse_calendar_time(text), std::nullopt) << text;
  }
}

TEST(WhatAUserTypes, IsRefusedWithWhatThereIs) {
  Layout layout;
  EXPECT_THROW(layout.set_columns("gx"), std::invalid_argument);
  EXPECT_THROW(layout.set_columns("speedo=v"), std::invalid_argument);
  EXPECT_THROW(layout.set_columns("t=a,t=b"), std::invalid_argument);
  EXPECT_THROW(layout.set_units("rate=hz"), std::invalid_argument);
  EXPECT_THROW(layout.set_units("rate=0dps"), std::invalid_argument);
  EXPECT_THROW(layout.set_units("velocity=mps"), std::invalid_argument);
  EXPECT_THROW(layout.set_delimiter("::"), std::invalid_argument);
}

/// Rates at 10 Hz from 0 s on; the speed as a function of the row's time where it is given.
class Motion : public ForeignFile {
 protected:
  template <class Speed>
  static std::string drive(std::size_t rows, Speed speed) {
    std::string text = "t_s,rate_dps,speed_mps\n";
    for (std::size_t k = 0; k < rows; ++k) {
      const double time_s = 0.1 * static_cast<double>(k);
      text += std::to_string(time_s) + ",0," + speed(time_s) + "\n";
    }
    return text;
  }

  /// Times [s] of the first and the last row of each run of rows that stand still.
  static std::vector<double> rests(const std::vector<Row>& rows) {
    std::vector<double> edges;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (!rows[k].still) continue;
      const double time_s = static_cast<double>(rows[k].time_ns) * 1e-9;
      if (k == 0 || !rows[k - 1].still) edges.push_back(time_s);
      if (k + 1 == rows.size() || !rows[k + 1].still) edges.push_back(time_s);
    }
    return edges;
  }
};

TEST_F(Motion, EndsWhereTheSpeedIsBelowTheDeadBand) {
  input_.speed = SpeedRule{.dead_band_m_s = 0.1};
  const auto rows = read(drive(100, [](double t) { return t < 3.05 || t > 6.05 ? "-2" : "0.05"; }));
  EXPECT_TRUE(columns_.still);
  EXPECT_FALSE(columns_.speed);
  // The row at 6.0 s is followed by motion within the interval of the speed.
  EXPECT_THAT(rests(rows),
              ElementsAre(::testing::DoubleNear(3.1, 1e-9), ::testing::DoubleNear(5.9, 1e-9)));
}

TEST_F(Motion, IsEarlierThanASpeedThatComesLate) {
  input_.speed = SpeedRule{.delay = core::Duration::milliseconds(500)};
  const auto rows = read(drive(100, [](double t) { return t < 3.05 || t > 6.05 ? "2" : "0"; }));
  EXPECT_THAT(rests(rows),
              ElementsAre(::testing::DoubleNear(2.6, 1e-9), ::testing::DoubleNear(5.4, 1e-9)));
}

TEST_F(Motion, IsAssumedWhereNoSpeedComes) {
  const auto rows = read(drive(100, [](double t) { return t > 2.05 && t < 7.95 ? "" : "0"; }));
  EXPECT_THAT(rests(rows),
              ElementsAre(::testing::DoubleNear(0.0, 1e-9), ::testing::DoubleNear(3.0, 1e-9),
                          ::testing::DoubleNear(8.0, 1e-9), ::testing::DoubleNear(9.9, 1e-9)));
  EXPECT_TRUE(rows[50].findings.has(Finding::motion_unknown));
  EXPECT_FALSE(rows[20].findings.has(Finding::motion_unknown));
}

TEST_F(Motion, MakesPulsesOfTheDistance) {
  input_.speed = SpeedRule{.metres_per_pulse = 0.5};
  const auto rows = read(drive(101, [](double) { return "3"; }));
  EXPECT_TRUE(columns_.odometer);
  EXPECT_FALSE(columns_.still);
  // 30 m from the first speed to the last; the sum of a hundred intervals may miss the last pulse.
  EXPECT_NEAR(static_cast<double>(rows.back().odometer_pulses), 60.0, 1.0);
}

TEST_F(Motion, ComesFromAFileOfItsOwnAtItsOwnRate) {
  input_.odometer_path =
      folder_.write("wheels.csv", "stamp,v\n0,7.2\n1000,7.2\n2000,0\n3000,0\n4000,0\n5000,1\n");
  input_.odometer_layout.set_columns("t=stamp,speed=v");
  input_.odometer_layout.set_units("time=ms,speed=kmh");
  std::string text = "t_s,rate_dps,odometer_pulses\n";
  for (int k = 0; k < 100; ++k) text += std::to_string(0.1 * k) + ",0," + std::to_string(k) + "\n";
  const auto rows = read(text);
  EXPECT_FALSE(columns_.odometer);
  EXPECT_EQ(rows[99].odometer_pulses, 0);
  // Between 4 s and 5 s the vehicle may already have moved; three intervals after 5 s nothing is
  // known.
  EXPECT_THAT(rests(rows),
              ElementsAre(::testing::DoubleNear(2.0, 1e-9), ::testing::DoubleNear(3.9, 1e-9)));
  EXPECT_FALSE(rows[79].findings.has(Finding::motion_unknown));
  EXPECT_TRUE(rows[81].findings.has(Finding::motion_unknown));
}

TEST_F(Motion, IsCountedByAFileOfPulses) {
  input_.odometer_path =
      folder_.write("wheels.csv", "t_s,odometer_pulses\n0,10\n1,13\n2,13\n3,12\n");
  std::string text = "t_s,rate_dps\n";
  for (int k = 0; k < 30; ++k) text += std::to_string(0.1 * k) + ",0\n";
  const auto rows = read(text);
  EXPECT_TRUE(columns_.odometer);
  EXPECT_EQ(rows[9].odometer_pulses, 0);
  EXPECT_EQ(rows[10].odometer_pulses, 3);
  EXPECT_EQ(rows[29].odometer_pulses, 3);
}

TEST_F(Motion, IsATurnOnTheSpot) {
  input_.layout.set_columns("speed=v,turn=w");
  input_.layout.set_units("speed=mps,rate=radps");
  const std::string turning = "t_s,rate_dps,v,w\n0,0,0,0.5\n0.1,0,0,-0.5\n0.2,0,0,-0.5\n";
  EXPECT_THAT(rests(read(turning)), ElementsAre());
  // Half a track of 0.3 m: the wheels go 0.075 m/s.
  input_.speed = SpeedRule{.dead_band_m_s = 0.074, .track_m = 0.3};
  EXPECT_THAT(rests(read(turning)), ElementsAre());
  input_.speed->dead_band_m_s = 0.076;
  EXPECT_FALSE(rests(read(turning)).empty());
  // A lost rate of turn leaves the motion unknown.
  input_.speed.reset();
  EXPECT_THAT(rests(read("t_s,rate_dps,v,w\n0,0,0,\n0.1,0,0,\n")), ElementsAre());
}

TEST_F(Motion, IsATurnOnlyBesideASpeed) {
  input_.layout.set_columns("turn=w");
  input_.layout.set_units("rate=radps");
  EXPECT_THAT(complaint("t_s,rate_dps,w\n0,0,0\n"), HasSubstr("--columns speed=NAME,turn=NAME"));
}

TEST_F(Motion, IsCountedByWheelsThatTurnAgainstEachOther) {
  input_.layout.set_columns("ticks1=left,ticks2=right");
  input_.layout.set_where("id=0");
  const auto rows = read(
      "t_s,rate_dps,left,right,id\n0,0,-100,7,0\n0.1,0,0,0,1\n0.2,0,-103,10,0\n0.3,0,-103,10,0\n");
  ASSERT_EQ(rows.size(), 3);
  EXPECT_TRUE(columns_.odometer);
  EXPECT_EQ(rows[0].odometer_pulses, 0);
  EXPECT_EQ(rows[1].odometer_pulses, 6);
  EXPECT_EQ(rows[2].odometer_pulses, 6);
  EXPECT_TRUE(rows[2].findings.empty());
  input_.layout.set_columns("pulses=id");
  EXPECT_THAT(complaint("t_s,rate_dps,left,right,id\n0,0,1,1,0\n"),
              HasSubstr("both pulses and ticks"));
}

TEST_F(Motion, NeedsASpeedForItsRule) {
  input_.speed = SpeedRule{.dead_band_m_s = 0.1};
  EXPECT_THAT(complaint("t_s,rate_dps\n0,1\n"), HasSubstr("--speed-column"));
}

struct Expected {
  const char* path;
  Columns columns;
  std::uint64_t rows;
  std::size_t ignored_columns;
};

void PrintTo(const Expected& expected, std::ostream* out) {
  *out << expected.path;
}

class RealRecording : public ::testing::TestWithParam<Expected> {};

// The counts of rows are those of `zcat FILE | tail -n +2 | wc -l`.
TEST_P(RealRecording, IsReadWholeWithoutALostOrMisplacedRow) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) {
    GTEST_SKIP() << "skipped: no recordings";
  }
  Reader reader{*folder / GetParam().path};
  EXPECT_EQ(reader.columns(), GetParam().columns);
  EXPECT_EQ(reader.ignored_columns().size(), GetParam().ignored_columns);
  for (Row row; reader.next(row);) {
  }
  const Findings& findings = reader.findings();
  EXPECT_EQ(findings.rows(), GetParam().rows);
  for (const Finding finding :
       {Finding::rate_lost, Finding::rate_implausible, Finding::temperature_lost,
        Finding::acceleration_lost, Finding::clock_step, Finding::time_stray, Finding::time_sorted,
        Finding::line_unterminated}) {
    EXPECT_EQ(findings.count(finding), 0) << description(finding);
  }
  EXPECT_EQ(doubt_of_acceleration(findings), "");
}

constexpr Columns kDegrees{3, RateUnit::deg_per_s, false, false, false};
constexpr Columns kRadians{3, RateUnit::rad_per_s, false, false, false};

INSTANTIATE_TEST_SUITE_P(
    Of, RealRecording,
    ::testing::Values(
        Expected{"adis16405_static/run1_100hz_raw.csv.gz", kDegrees, 1'000'000, 0},
        Expected{"adis16405_static/run2_10hz_mean.csv.gz", kDegrees, 100'000, 0},
        Expected{
            "adis16405_static/run3_1hz_mean_with_accel.csv.gz", {.acceleration = true}, 10'000, 0},
        Expected{"thermal_sweep/imu_thermal_2hz.csv.gz",
                 {.rate_unit = RateUnit::rad_per_s, .temperature = true, .acceleration = true},
                 8'400,
                 0},
        Expected{"mpu6050_static_temp/mpu6050_100hz.csv.gz",
                 {3, RateUnit::deg_per_s, true, false, false},
                 65'067,
                 0},
        Expected{"xsens_multiposition/xsens_mti_100hz.csv.gz",
                 {3, RateUnit::rad_per_s, false, false, true},
                 51'175,
                 6},
        Expected{"husky_robot/imu_30hz.csv.gz", kRadians, 11'865, 0}));

TEST(RealWheelOdometry, IsRefusedForWantOfAGyro) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) {
    GTEST_SKIP() << "skipped: no recordings";
  }
  try {
    const Reader reader{*folder / "husky_robot/odom_10hz.csv.gz"};
    ADD_FAILURE() << "a file without a gyro was accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("expected gyro columns named gx_dps"));
  }
}

}  // namespace
}  // namespace zerorate::recording

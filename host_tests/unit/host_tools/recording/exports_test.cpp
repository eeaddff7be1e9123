#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/number.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {
namespace {

using ::testing::HasSubstr;

constexpr float kDegreePerSecond = 0.017453292519943295F;

/// A recording and what was found in it.
struct WholeFile {
  std::vector<Row> rows;
  Columns columns;
};

WholeFile read_whole(const Input& input) {
  Reader reader{input};
  WholeFile result{.columns = reader.columns()};
  for (Row row; reader.next(row);) result.rows.push_back(row);
  return result;
}

/// A file of a program with samples at 0.01 s and 0.02 s, whose rates are 0.25, -0.5, 1 and
/// 0.25, -0.5, 2, in the unit of the program.
struct Exported {
  std::string_view name;
  std::string_view file;
  std::string_view program;
  std::string_view text;
  float unit_rad_s = 1.0F;
};

class KnownExport : public ::testing::TestWithParam<Exported> {};

TEST_P(KnownExport, IsReadWithoutOptions) {
  const Exported& one = GetParam();
  const zerorate::testing::ScratchFolder folder;
  const WholeFile result = read_whole(folder.write(std::string(one.file), one.text));
  EXPECT_EQ(result.columns.program, one.program);
  ASSERT_EQ(result.rows.size(), 2);
  EXPECT_EQ(result.rows[1].time_ns - result.rows[0].time_ns, 10'000'000);
  EXPECT_FLOAT_EQ(result.rows[0].rate_rad_s[0], 0.25F * one.unit_rad_s);
  EXPECT_FLOAT_EQ(result.rows[0].rate_rad_s[1], -0.5F * one.unit_rad_s);
  EXPECT_FLOAT_EQ(result.rows[1].rate_rad_s[2], 2.0F * one.unit_rad_s);
}

INSTANTIATE_TEST_SUITE_P(
    Of, KnownExport,
    ::testing::Values(
        Exported{"phyphox_with_decimal_commas", "raw.csv", "phyphox",
                 "\"Time (s)\";\"Gyroscope x (rad/s)\";\"Gyroscope y (rad/s)\";"
                 "\"Gyroscope z (rad/s)\";\"Absolute (rad/s)\"\n"
                 "1,000000000E-02;2,5E-01;-5E-01;1E+00;1,1E0\n"
                 "2,000000000E-02;2,5E-01;-5E-01;2E+00;1,1E0\n"},
        Exported{"phyphox_with_points", "raw.csv", "phyphox",
                 "Time (s),Gyroscope x (rad/s),Gyroscope y (rad/s),Gyroscope z (rad/s)\n"
                 "0.01,0.25,-0.5,1\n0.02,0.25,-0.5,2\n"},
        Exported{"sensor_logger", "Gyroscope.csv", "Sensor Logger",
                 "time,seconds_elapsed,z,y,x\n"
                 "1650000000010000000,0.01,1,-0.5,0.25\n1650000000020000000,0.02,2,-0.5,0.25\n"},
        Exported{
            "androsensor", "log.csv", "AndroSensor",
            "GYROSCOPE X (rad/s);GYROSCOPE Y (rad/s);GYROSCOPE Z (rad/s);"
            "Time since start in ms ;YYYY-MO-DD HH-MI-SS_SSS\n"
            "0.25;-0.5;1;10;2021-03-04 12:00:00:010\n0.25;-0.5;2;20;2021-03-04 12:00:00:020\n"},
        Exported{"androsensor_calendar", "log.csv", "AndroSensor",
                 "YYYY-MO-DD HH-MI-SS_SSS;GYROSCOPE X (rad/s);GYROSCOPE Y (rad/s);"
                 "GYROSCOPE Z (rad/s)\n"
                 "2021-03-04 12:00:59:995;0.25;-0.5;1\n2021-03-04 12:01:00:005;0.25;-0.5;2\n"},
        Exported{"px4_combined", "f.csv", "PX4 (sensor_combined)",
                 "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],gyro_integral_dt,"
                 "accelerometer_m_s2[0],accelerometer_m_s2[1],accelerometer_m_s2[2]\n"
                 "10000,0.25,-0.5,1,4000,0,0,-9.8\n20000,0.25,-0.5,2,4000,0,0,-9.8\n"},
        Exported{"px4_gyro", "flight_sensor_gyro_0.csv", "PX4 (sensor_gyro)",
                 "timestamp,timestamp_sample,device_id,x,y,z,temperature,error_count\n"
                 "10000,9000,7,0.25,-0.5,1,31,0\n20000,19000,7,0.25,-0.5,2,31,0\n"},
        Exported{"px4_increments", "f.csv", "PX4 (vehicle_imu)",
                 "timestamp,delta_angle[0],delta_angle[1],delta_angle[2],delta_angle_dt\n"
                 "10000,0.0025,-0.005,0.01,10000\n20000,0.0025,-0.005,0.02,10000\n"},
        Exported{"ardupilot_of_two_sensors", "imu.csv", "ArduPilot (IMU, the first one)",
                 "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\n10000,0,0.25,-0.5,1,0,0,-9.8\n"
                 "10000,1,9,9,9,0,0,-9.8\n20000,0,0.25,-0.5,2,0,0,-9.8\n20000,1,9,9,9,0,0,-9.8\n"},
        Exported{"ardupilot_of_one_sensor", "imu.csv", "ArduPilot (IMU)",
                 "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\n10000,0.25,-0.5,1,0,0,-9.8\n"
                 "20000,0.25,-0.5,2,0,0,-9.8\n"},
        Exported{"blackbox_behind_its_settings", "explorer.csv", "Blackbox",
                 "\"Product\",\"flight data recorder\"\n\"looptime\",\"125\"\n"
                 "\"loopIteration\",\"time\",\"gyroADC[0]\",\"gyroADC[1]\",\"gyroADC[2]\"\n"
                 "0,10000,0.25,-0.5,1\n8,20000,0.25,-0.5,2\n",
                 kDegreePerSecond},
        Exported{"blackbox_with_spaces", "decoder.csv", "Blackbox",
                 "loopIteration, time (us), gyroADC[0], gyroADC[1], gyroADC[2]\n"
                 "0, 10000, 0.25, -0.5, 1\n8, 20000, 0.25, -0.5, 2\n",
                 kDegreePerSecond}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(KnownExportByName, OfAnAccelerometerIsNone) {
  const zerorate::testing::ScratchFolder folder;
  std::filesystem::create_directory(folder.path() / "Gyroscope");
  const Input input{
      folder.write("Gyroscope/Accelerometer.csv", "time,seconds_elapsed,z,y,x\n1,0,1,2,3\n")};
  EXPECT_THROW(static_cast<void>(Reader{input}), Error);
}

TEST(NamedColumnsBehindOtherLines, AreFound) {
  const zerorate::testing::ScratchFolder folder;
  Input input{folder.write("log.csv", "device,7\nstarted,now\nstamp,wz\n0,1\n1,2\n")};
  input.layout.set_columns("t=stamp,gz=wz");
  input.layout.set_units("time=s,rate=dps");
  EXPECT_EQ(read_whole(input).rows.size(), 2);
}

TEST(RecordingInOtherEncodings, IsReadAsInUtf8) {
  const std::string text = "t_s,rate_dps\n0,1\n1,2\n";
  std::string little = "\xFF\xFE";
  std::string big = "\xFE\xFF";
  std::string returns;
  for (const char c : text) {
    little.append({c, '\0'});
    big.append({'\0', c});
    returns.push_back(c == '\n' ? '\r' : c);
  }
  const zerorate::testing::ScratchFolder folder;
  for (const std::string& other : {little, big, returns, "\xEF\xBB\xBF" + text}) {
    const WholeFile result = read_whole(folder.write("log.csv", other));
    ASSERT_EQ(result.rows.size(), 2);
    EXPECT_FLOAT_EQ(result.rows[1].rate_rad_s[0], 2.0F * kDegreePerSecond);
  }
}

TEST(TimeOfALogger, IsReadAsItWritesIt) {
  constexpr std::int64_t kHalfPastNoon_ns = 45'000'000'000'000;
  EXPECT_EQ(parse_calendar_time("12:30:00.250"), kHalfPastNoon_ns + 250'000'000);
  EXPECT_EQ(parse_calendar_time("12:30:00,25"), kHalfPastNoon_ns + 250'000'000);
  EXPECT_EQ(parse_calendar_time("1970/01/01 12:30:00:250"), kHalfPastNoon_ns + 250'000'000);
  EXPECT_EQ(parse_calendar_time("1970-01-01T12:29:60.5Z"), kHalfPastNoon_ns + 500'000'000);
  EXPECT_EQ(parse_calendar_time("12:30"), std::nullopt);
  EXPECT_EQ(parse_calendar_time("12:30:61"), std::nullopt);
  EXPECT_EQ(parse_calendar_time("12:30:00."), std::nullopt);
  EXPECT_EQ(parse_calendar_time("12:30:00.2.5"), std::nullopt);
}

/// Angles of samples, 20 ms apart, of which one is missing.
TEST(AnglesOfSamples, BecomeRates) {
  const zerorate::testing::ScratchFolder folder;
  std::string text = "t,a\n";
  for (int k = 0; k < 12; ++k) {
    if (k < 8 || k > 10)
      text += std::to_string(20 * k) + "," + std::to_string(k < 3 ? 40 : 60) + "\n";
  }
  Input input{folder.write("log.csv", text)};
  input.layout.set_columns("t=t,rate=a");
  input.layout.set_units("time=ms,rate=0.001deg/sample");
  const WholeFile result = read_whole(input);
  ASSERT_EQ(result.rows.size(), 9);
  EXPECT_FLOAT_EQ(result.rows[0].rate_rad_s[0], 2.0F * kDegreePerSecond)
      << "by the time to the next row";
  EXPECT_FLOAT_EQ(result.rows[2].rate_rad_s[0], 2.0F * kDegreePerSecond);
  EXPECT_FLOAT_EQ(result.rows[3].rate_rad_s[0], 3.0F * kDegreePerSecond);
  EXPECT_TRUE(std::isnan(result.rows[8].rate_rad_s[0])) << "of one sample or of four";
  EXPECT_FALSE(result.columns.are_increments);
}

class KittiFolder : public ::testing::Test {
 protected:
  void sample(int number, std::string_view stamp, std::string_view numbers) {
    stamps_.append(stamp).append("\n");
    std::filesystem::create_directories(folder_.path() / "oxts" / "data");
    folder_.write("oxts/timestamps.txt", stamps_);
    folder_.write("oxts/data/000000000" + std::to_string(number) + ".txt", numbers);
  }

  static constexpr std::string_view kNumbers =
      "49 8 116 0 0 0 0 0 5 0 0 0.1 0.2 9.8 0 0 0 0.25 -0.5 1 0 0 0 0 0 0 0 0 0 0\n";

  zerorate::testing::ScratchFolder folder_;
  std::string stamps_;
};

TEST_F(KittiFolder, IsReadAsItIs) {
  sample(0, "2011-09-26 13:02:59.995000000", kNumbers);
  sample(1, "2011-09-26 13:03:00.005000000", kNumbers);
  const WholeFile result = read_whole(folder_.path());
  ASSERT_EQ(result.rows.size(), 2);
  EXPECT_EQ(result.rows[1].time_ns - result.rows[0].time_ns, 10'000'000);
  EXPECT_FLOAT_EQ(result.rows[1].rate_rad_s[2], 1.0F);
  EXPECT_FLOAT_EQ(result.rows[1].acceleration_m_s2[2], 9.8F);
  EXPECT_FALSE(result.rows[1].still) << "at 5 m/s";
  EXPECT_EQ(read_whole(folder_.path() / "oxts" / "data").rows.size(), 2) << "beside its stamps";
}

TEST_F(KittiFolder, WithATornSampleNamesItsFile) {
  sample(0, "2011-09-26 13:02:59.995000000", kNumbers);
  sample(1, "2011-09-26 13:03:00.005000000", "49 8 116\n");
  try {
    static_cast<void>(read_whole(folder_.path()));
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("0000000001.txt"));
    EXPECT_THAT(error.what(), HasSubstr("3 numbers"));
  }
}

}  // namespace
}  // namespace zerorate::recording

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <ostream>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {
namespace {

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
        Finding::time_backwards, Finding::time_duplicate, Finding::line_unterminated}) {
    EXPECT_EQ(findings.count(finding), 0) << description(finding);
  }
}

constexpr Columns kDegrees{3, RateUnit::deg_per_s, false, false, false};
constexpr Columns kRadians{3, RateUnit::rad_per_s, false, false, false};

INSTANTIATE_TEST_SUITE_P(
    Of, RealRecording,
    ::testing::Values(Expected{"adis16405_static/run1_100hz_raw.csv.gz", kDegrees, 1'000'000, 0},
                      Expected{"adis16405_static/run2_10hz_mean.csv.gz", kDegrees, 100'000, 0},
                      Expected{"adis16405_static/run3_1hz_mean_with_accel.csv.gz", kDegrees, 10'000,
                               3},
                      Expected{"thermal_sweep/imu_thermal_2hz.csv.gz",
                               {3, RateUnit::rad_per_s, true, false, false},
                               8'400,
                               3},
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

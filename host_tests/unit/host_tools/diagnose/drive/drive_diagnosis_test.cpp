// Records of drives that were written by hand: what was put into the errors is found.

#include "host_tools/lib/diagnose/drive/drive_diagnosis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kRadPerDeg;

constexpr double kNoise_rad = 0.1 * kRadPerDeg;

/// 24 drives whose turns, lengths and paths differ, with independent errors.
DriveRecord drives_with_noise(double noise_rad) {
  DriveRecord record;
  record.vertical = {.axis = 2, .sign = 1.0};
  const auto stream = random::RandomStream{7}.substream("drives");
  constexpr int kDrives = 24;
  for (int k = 0; k < kDrives; ++k) {
    DriveEvidence drive;
    drive.departure_s = 100.0 * k;
    drive.length_s = 40.0 + 5.0 * (k * 7 % 11);
    drive.moving_s = drive.length_s - 4.0;
    drive.metres = drive.moving_s * (5.0 + k * 5 % 7);
    drive.turn_rad = (k % 2 == 0 ? 1.0 : -1.0) * (1.0 + 0.3 * (k * 3 % 10));
    drive.path_rad = std::abs(drive.turn_rad) + 0.2 * (k * 5 % 13);
    drive.error_rad = noise_rad * stream.normal(k);
    record.drives.push_back(drive);
    record.number.push_back(static_cast<std::size_t>(k));
  }
  record.bias_rad2 = Eigen::MatrixXd::Identity(kDrives, kDrives) * kNoise_rad * kNoise_rad;
  return record;
}

DriveDiagnosis diagnosed(const DriveRecord& record) {
  model::SensorModel model = model::find_model("lsm6dso");
  return diagnose_drives(record, model);
}

TEST(DrivesByHand, NoiseAloneIsConsistent) {
  const DriveDiagnosis diagnosis = diagnosed(drives_with_noise(kNoise_rad));
  EXPECT_TRUE(diagnosis.causes.empty());
  EXPECT_EQ(diagnosis.verdict, Verdict::consistent);
}

TEST(DrivesByHand, AShareOfTheTurnIsAScaleFactor) {
  DriveRecord record = drives_with_noise(kNoise_rad);
  for (DriveEvidence& drive : record.drives) drive.error_rad += 0.01 * drive.turn_rad;
  const DriveDiagnosis diagnosis = diagnosed(record);
  ASSERT_EQ(diagnosis.causes.size(), 1);
  EXPECT_EQ(diagnosis.causes[0].effect, "scale_factor");
  const Parameter& percent = diagnosis.causes[0].parameters.at(0);
  EXPECT_LE(percent.lo, 1.0);
  EXPECT_GE(percent.hi, 1.0);
}

// The noise of the model is in the interval whatever few drives happen to show.
TEST(DrivesByHand, QuietDrivesDoNotNarrowTheInterval) {
  DriveRecord record = drives_with_noise(0.1 * kNoise_rad);
  double squares_s2 = 0.0;
  for (DriveEvidence& drive : record.drives) {
    const double seconds_at_10_mps = drive.metres / 10.0;
    drive.error_rad += 0.01 * kRadPerDeg * seconds_at_10_mps;
    squares_s2 += seconds_at_10_mps * seconds_at_10_mps;
  }
  const DriveDiagnosis diagnosis = diagnosed(record);
  ASSERT_EQ(diagnosis.causes.size(), 1);
  const Parameter& offset = diagnosis.causes[0].parameters.at(0);
  EXPECT_EQ(offset.name, "offset_at_10_mps_dps");
  EXPECT_GE(offset.hi - offset.lo, 2.0 * 1.96 * kNoise_rad / kRadPerDeg / std::sqrt(squares_s2));
}

TEST(DrivesByHand, AScatterIsTheReferencesUpToALimit) {
  const DriveDiagnosis small = diagnosed(drives_with_noise(4.0 * kNoise_rad));
  EXPECT_EQ(small.verdict, Verdict::consistent);
  ASSERT_EQ(small.remarks.size(), 1);
  EXPECT_NE(small.remarks[0].find("error of the reference was estimated"), std::string::npos);
  const DriveDiagnosis large = diagnosed(drives_with_noise(30.0 * kNoise_rad));
  EXPECT_EQ(large.verdict, Verdict::unexplained);
}

/// Names of the causes, in alphabetical order.
std::vector<std::string> names_of(const DriveDiagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const Cause& cause : diagnosis.causes) names.push_back(cause.effect);
  std::ranges::sort(names);
  return names;
}

// Each is as large as the other: alone, one would leave half of the squares.
TEST(DrivesByHand, OfTwoSharesNeitherHidesTheOther) {
  DriveRecord record = drives_with_noise(kNoise_rad);
  for (DriveEvidence& drive : record.drives) {
    drive.error_rad += 0.003 * drive.turn_rad - 0.003 * drive.path_rad;
  }
  const std::vector<std::string> both{"scale_asymmetry", "scale_factor"};
  EXPECT_EQ(names_of(diagnosed(record)), both);
}

/// Turns by axes that stand askew by 3 deg, about the y axis; the errors are none.
DriveRecord drives_askew() {
  constexpr double kTilt_rad = 3.0 * kRadPerDeg;
  DriveRecord record = drives_with_noise(kNoise_rad);
  const auto stream = random::RandomStream{8}.substream("axes");
  for (std::size_t k = 0; k < record.size(); ++k) {
    DriveEvidence& drive = record.drives[k];
    const auto place = static_cast<std::int64_t>(3 * k);
    drive.turned_rad = {
        std::sin(kTilt_rad) * drive.turn_rad + 0.1 * kNoise_rad * stream.normal(place),
        0.1 * kNoise_rad * stream.normal(place + 1), std::cos(kTilt_rad) * drive.turn_rad};
  }
  return record;
}

TEST(DrivesByHand, ATiltOfTheAxesIsMisalignment) {
  DriveRecord record = drives_askew();
  for (DriveEvidence& drive : record.drives) {
    drive.error_rad += drive.turned_rad[2] - drive.turn_rad;
  }
  EXPECT_EQ(names_of(diagnosed(record)), std::vector<std::string>{"misalignment"});
}

// The scale factor makes up for the cosine: the errors of the heading show nothing.
TEST(DrivesByHand, ATiltIsNamedWhereAScaleFactorHidesIt) {
  const std::vector<std::string> both{"misalignment", "scale_factor"};
  EXPECT_EQ(names_of(diagnosed(drives_askew())), both);
}

/// Drives whose path grows with their time. Each has four windows, of which two are straight, and
/// the windows have independent errors.
DriveRecord drives_in_windows(double asymmetry, double offset_rad_s) {
  constexpr std::size_t kWindows = 4;
  constexpr double kWindowNoise_rad = kNoise_rad / 2.0;
  DriveRecord record = drives_with_noise(0.0);
  const auto stream = random::RandomStream{9}.substream("windows");
  for (std::size_t k = 0; k < record.size(); ++k) {
    DriveEvidence& drive = record.drives[k];
    DriveEvidence part{.length_s = drive.length_s / kWindows,
                       .moving_s = drive.moving_s / kWindows};
    part.metres = drive.metres / kWindows;
    drive.path_rad = 0.05 * drive.moving_s;
    for (std::size_t i = 0; i < kWindows; ++i) {
      part.turn_rad = i % 2 == 0 ? drive.turn_rad / 2.0 : 0.0;
      part.path_rad = i % 2 == 0 ? drive.path_rad / 2.0 : 0.0;
      part.error_rad =
          kWindowNoise_rad * stream.normal(static_cast<std::int64_t>(kWindows * k + i)) +
          asymmetry * part.path_rad + offset_rad_s * part.moving_s;
      drive.error_rad += part.error_rad;
      if (i + 1 < kWindows) record.windows.push_back({.drive = k, .index = i, .sums = part});
    }
  }
  const auto rows = static_cast<Eigen::Index>(record.rows());
  const auto drives = static_cast<Eigen::Index>(record.size());
  record.bias_rad2 = Eigen::MatrixXd::Identity(rows, rows) * kWindowNoise_rad * kWindowNoise_rad;
  record.bias_rad2.topLeftCorner(drives, drives) *= kWindows;
  for (std::size_t w = 0; w < record.windows.size(); ++w) {
    const auto row = drives + static_cast<Eigen::Index>(w);
    const auto drive = static_cast<Eigen::Index>(record.windows[w].drive);
    record.bias_rad2(row, drive) = record.bias_rad2(row, row);
    record.bias_rad2(drive, row) = record.bias_rad2(row, row);
  }
  return record;
}

// Path and time of whole drives are the same column, but for a factor.
TEST(DrivesByHand, WindowsTellAnAsymmetryFromAnOffset) {
  const DriveRecord asymmetric = drives_in_windows(0.004, 0.0);
  const DriveDiagnosis by_windows = diagnosed(asymmetric);
  EXPECT_EQ(names_of(by_windows), std::vector<std::string>{"scale_asymmetry"});
  EXPECT_TRUE(by_windows.causes.at(0).alternatives.empty());
  EXPECT_EQ(names_of(diagnosed(drives_in_windows(0.0, 2e-4))),
            std::vector<std::string>{"bias_in_motion"});
  const DriveDiagnosis by_drives = diagnosed(whole_drives(asymmetric));
  ASSERT_EQ(by_drives.causes.size(), 1);
  EXPECT_FALSE(by_drives.causes[0].alternatives.empty());
}

// The reference wanders on the way more than at the stops: its windows weigh less.
TEST(DrivesByHand, ScatterOfWindowsDoesNotTouchTheDrives) {
  DriveRecord record = drives_in_windows(0.0, 0.0);
  const auto stream = random::RandomStream{10}.substream("headings");
  for (std::size_t w = 0; w < record.windows.size(); ++w) {
    record.windows[w].sums.error_rad +=
        10.0 * kNoise_rad * stream.normal(static_cast<std::int64_t>(w));
  }
  const DriveDiagnosis diagnosis = diagnosed(record);
  EXPECT_TRUE(diagnosis.causes.empty());
  EXPECT_EQ(diagnosis.verdict, Verdict::consistent);
}

TEST(DrivesByHand, FewDrivesAreNotDiagnosed) {
  DriveRecord record = drives_with_noise(kNoise_rad);
  record.drives.resize(5);
  EXPECT_NE(diagnosed(record).obstacle.find("6 are needed"), std::string::npos);
}

}  // namespace
}  // namespace zerorate::diagnose

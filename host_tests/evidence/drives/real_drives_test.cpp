// The hour of a car with a reference of heading: no cause in the ring-laser gyro as it is, and a
// scale factor where one is put into its rates beside the noise of a MEMS gyro at rest.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <utility>

#include "firmware/model/catalogue.hpp"
#include "host_tests/evidence/drives/made_drive.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lib/diagnose/drive/drive_diagnosis.hpp"

namespace zerorate::drives {
namespace {

void write(const Drive& drive, const std::filesystem::path& path) {
  std::ofstream file(path);
  file << "t_s,gx_dps,gy_dps,gz_dps,odometer_pulses,ref_heading_deg,ref_speed_mps\n";
  for (std::size_t k = 0; k < drive.measured_dps.size(); ++k) {
    const Axes& rate = drive.measured_dps[k];
    file << fmt::format("{:.1f},{:.7f},{:.7f},{:.7f},{:.0f},{:.5f},{:.4f}\n",
                        drive.period_s * static_cast<double>(k), rate[0], rate[1], rate[2],
                        drive.odometer_pulses[k], drive.heading_deg[k], drive.speed_mps[k]);
  }
}

diagnose::DriveDiagnosis diagnosis_of(const Drive& drive, model::SensorModel model) {
  const zerorate::testing::ScratchFolder folder;
  const recording::Input input{folder.path() / "hour.csv"};
  write(drive, input.path);
  recording::Reader reader{input};
  const truth::Track track = truth::read_track(reader);
  const truth::Truth truth = truth::find_truth(track, {});
  return diagnose::diagnose_drives(diagnose::read_drive_record(input, track, truth, model), model);
}

/// The rates with a scale factor, and with the noise from a place of a rest.
Drive with_noise(Drive drive, double scale_error, const Rest& rest, std::size_t first) {
  for (std::size_t k = 0; k < drive.measured_dps.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      double& rate = drive.measured_dps[k].at(i);
      rate = (1.0 + scale_error) * rate + rest.rate_dps[first + k].at(i);
    }
  }
  return drive;
}

class HourOfACar : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
    if (!folder) GTEST_SKIP() << "skipped: no recordings";
    folder_ = *folder;
    drive_ = ring_laser_drive(folder_);
  }

  std::filesystem::path folder_;
  Drive drive_;
};

TEST_F(HourOfACar, OfARingLaserGyroHasNoCause) {
  const auto diagnosis = diagnosis_of(drive_, model::find_model("lsm6dso"));
  EXPECT_EQ(diagnosis.drives, 20);
  EXPECT_TRUE(diagnosis.causes.empty()) << diagnosis.causes.front().sentence;
}

// The errors of a MEMS gyro that was driven downtown, -0.83 %, and of a usual data sheet.
TEST_F(HourOfACar, WithAScaleFactorHasItAlone) {
  const std::size_t places[] = {0, 40'000};
  for (const int run : {1, 2, 3}) {
    const Rest rest = adis16405_rest(folder_, run, 1.0);
    for (const std::size_t first : places) {
      const auto none =
          diagnosis_of(with_noise(drive_, 0.0, rest, first), model::find_model("adis16405"));
      EXPECT_TRUE(none.causes.empty()) << none.causes.front().sentence;
      for (const double percent : {-0.83, 1.0}) {
        const auto diagnosis = diagnosis_of(with_noise(drive_, 0.01 * percent, rest, first),
                                            model::find_model("adis16405"));
        ASSERT_EQ(diagnosis.causes.size(), 1) << percent << " in run " << run;
        const diagnose::Cause& cause = diagnosis.causes.front();
        EXPECT_EQ(cause.effect, "scale_factor");
        EXPECT_TRUE(cause.stands_alone());
        EXPECT_LE(cause.parameters.front().lo, percent) << run;
        EXPECT_GE(cause.parameters.front().hi, percent) << run;
      }
    }
  }
}

}  // namespace
}  // namespace zerorate::drives

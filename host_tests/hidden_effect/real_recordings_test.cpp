/// @file
/// What the diagnosis says of real recordings, against what is known of them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "host_tests/support/recordings_folder.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::diagnose {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;

class DiagnosisOfRealRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
    if (!folder_) GTEST_SKIP() << "skipped: no recordings";
  }

  [[nodiscard]] Diagnosis diagnosis_of(const char* file, std::size_t axis) const {
    recording::Reader reader{*folder_ / file};
    return diagnose(record_of(identify::read_rest_samples(reader), axis));
  }

 private:
  std::optional<std::filesystem::path> folder_;
};

/// Causes, and what the recording does not tell apart from them.
std::set<std::string> mentioned(const Diagnosis& diagnosis) {
  std::set<std::string> names;
  for (const Cause& cause : diagnosis.causes) {
    names.insert(cause.effect);
    for (const Alternative& rival : cause.alternatives) names.insert(rival.effect);
  }
  return names;
}

TEST_F(DiagnosisOfRealRecording, NamesTheTemperatureOfTheSweepOnY) {
  const Diagnosis y = diagnosis_of("thermal_sweep/imu_thermal_2hz.csv.gz", 1);
  EXPECT_THAT(mentioned(y), Contains("temperature_drift"));
}

TEST_F(DiagnosisOfRealRecording, LeavesTheHysteresisOfTheSweepOnXUnexplained) {
  const Diagnosis x = diagnosis_of("thermal_sweep/imu_thermal_2hz.csv.gz", 0);
  EXPECT_EQ(x.verdict, Verdict::unexplained);
}

TEST_F(DiagnosisOfRealRecording, NamesTheLostSamplesOfTheMpu6050) {
  EXPECT_THAT(mentioned(diagnosis_of("mpu6050_static_temp/mpu6050_100hz.csv.gz", 2)),
              Contains("dropped_samples"));
}

TEST_F(DiagnosisOfRealRecording, NamesASlowExcessOfTheAdis16405) {
  const auto slow = AnyOf("fractional_order", "rate_random_walk", "correlated_noise", "rate_ramp",
                          "warm_up_transient", "bias_jump");
  for (const std::size_t axis : {1U, 2U}) {
    EXPECT_THAT(mentioned(diagnosis_of("adis16405_static/run1_1hz_mean_with_accel.csv.gz", axis)),
                Contains(slow))
        << axis;
  }
}

}  // namespace
}  // namespace zerorate::diagnose

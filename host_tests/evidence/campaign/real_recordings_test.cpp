/// @file
/// Diagnosis of real recordings, against what is known of them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/contest/drives.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::diagnose {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::Gt;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Lt;
using ::testing::Not;
using ::testing::Optional;

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
  [[nodiscard]] static std::vector<Diagnosis> diagnosis_of_all(const std::filesystem::path& file) {
    recording::Reader reader{file};
    const identify::RestSamples samples = identify::read_rest_samples(reader);
    std::vector<Record> axes;
    for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
      axes.push_back(record_of(samples, axis));
    }
    return diagnose(std::move(axes));
  }

  /// 1 Hz means of three runs of 10,000 s at rest.
  [[nodiscard]] std::vector<std::filesystem::path> means_of_the_adis16405() const {
    std::vector<std::filesystem::path> runs;
    for (const char* run : {"run1", "run2", "run3"}) {
      runs.push_back(*folder_ / "adis16405_static" /
                     (std::string(run) + "_1hz_mean_with_accel.csv.gz"));
    }
    return runs;
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

TEST_F(DiagnosisOfRealRecording, NamesTheTemperatureFirstOnY) {
  const Diagnosis y = diagnosis_of("thermal_sweep/imu_thermal_2hz.csv.gz", 1);
  ASSERT_FALSE(y.causes.empty());
  EXPECT_EQ(y.causes.front().effect, "temperature_drift");
}

TEST_F(DiagnosisOfRealRecording, LeavesTheHysteresisOfTheSweepOnX) {
  const Diagnosis x = diagnosis_of("thermal_sweep/imu_thermal_2hz.csv.gz", 0);
  EXPECT_EQ(x.verdict, Verdict::unexplained);
  ASSERT_FALSE(x.causes.empty());
  EXPECT_EQ(x.causes.front().effect, "temperature_drift");
  EXPECT_THAT(x.remarks, Contains(HasSubstr("The first sample")));
}

TEST_F(DiagnosisOfRealRecording, NamesTheGapsOfTheMpu6050) {
  const Diagnosis z = diagnosis_of("mpu6050_static_temp/mpu6050_100hz.csv.gz", 2);
  const auto dropped = std::ranges::find(z.causes, "dropped_samples", &Cause::effect);
  ASSERT_NE(dropped, z.causes.end());
  EXPECT_THAT(dropped->sentence, Not(HasSubstr("81 %")));
  // data/README.md: 2,860 gaps over 50 ms.
  EXPECT_EQ(dropped->parameters.front().name, "gaps");
  EXPECT_NEAR(dropped->parameters.front().value, 2860.0, 0.03 * 2860.0);
}

TEST_F(DiagnosisOfRealRecording, NamesACommonOrderOfTheAdis16405) {
  for (const std::filesystem::path& run : means_of_the_adis16405()) {
    for (const Diagnosis& diagnosis : diagnosis_of_all(run)) {
      const auto order = std::ranges::find(diagnosis.causes, "fractional_order", &Cause::effect);
      ASSERT_NE(order, diagnosis.causes.end()) << run << ' ' << diagnosis.axis;
      EXPECT_EQ(order->axes, 3U);
      EXPECT_EQ(diagnosis.verdict, Verdict::explained);
      // Run 1 begins with a jump of x that comes back within minutes; the means of 0.1 s have it,
      // too.
      const bool has_jump = run.filename().string().starts_with("run1") && diagnosis.axis == "x";
      EXPECT_EQ(diagnosis.causes.size(), has_jump ? 2U : 1U) << run << ' ' << diagnosis.axis;
      if (!has_jump) continue;
      EXPECT_EQ(diagnosis.causes.front().effect, "relaxation");
      EXPECT_EQ(diagnosis.causes.front().parameters.back().name, "largest_time_s");
      EXPECT_NEAR(diagnosis.causes.front().parameters.back().value, 51.0, 5.0);
    }
  }
}

TEST_F(DiagnosisOfRealRecording, GivesBetterModelsForOtherRuns) {
  const contest::DriveContestOptions options{
      .schedules = {{15.0, 60.0}, {30.0, 120.0}, {60.0, 300.0}, {20.0, 300.0}, {120.0, 600.0}},
      .fit_by = contest::FitBy::diagnosis};
  const contest::DriveContest contest =
      contest::run_drive_contest(means_of_the_adis16405(), options, {});
  // 0.981; it was 0.975 before the learning bank had random walks, which take the place of some
  // extensions.
  EXPECT_LT(contest.extended_over_base.value, 0.99);
  const auto& extended =
      contest.overall[static_cast<std::size_t>(contest::Contestant::kalman_extended)];
  EXPECT_GT(extended.coverage.value, 0.94);
  EXPECT_LT(extended.coverage.value, 0.96);
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

/// The frequency of the periodic disturbance; nothing where none is named.
std::optional<double> line_hz(const Diagnosis& diagnosis) {
  const auto line = std::ranges::find(diagnosis.causes, "periodic_disturbance", &Cause::effect);
  if (line == diagnosis.causes.end()) return std::nullopt;
  return std::ranges::find(line->parameters, "frequency_hz", &Parameter::name)->value;
}

TEST_F(DiagnosisOfRealRecording, NamesTheLineOnXOfTheAdis16405) {
  for (const char* file :
       {"adis16405_static/run1_10hz_mean.csv.gz", "adis16405_static/run2_10hz_mean.csv.gz",
        "adis16405_static/run3_10hz_mean.csv.gz"}) {
    // data/README.md: at 0.54 to 0.57 Hz.
    EXPECT_THAT(line_hz(diagnosis_of(file, 0)), Optional(AllOf(Gt(0.535), Lt(0.575)))) << file;
  }
}

TEST_F(DiagnosisOfRealRecording, NamesTheHumpOnZOfTheAdis16405) {
  const Diagnosis z = diagnosis_of("adis16405_static/run2_100hz_raw.csv.gz", 2);
  // data/README.md: at 15 to 22 Hz.
  EXPECT_THAT(line_hz(z), Optional(AllOf(Gt(15.0), Lt(22.0))));
  EXPECT_THAT(mentioned(z), IsSupersetOf({"quantization", "sensor_bandwidth", "fractional_order"}));
}

/// Causes that means over a second show, with a probability that a reader would see.
std::set<std::string> slow_causes(const Diagnosis& diagnosis) {
  std::set<std::string> names;
  for (const Cause& cause : diagnosis.causes) {
    for (const char* slow : {"fractional_order", "rate_random_walk", "rate_ramp", "bias_jump",
                             "relaxation", "warm_up_transient"}) {
      if (cause.effect == slow) names.insert(cause.effect);
    }
  }
  return names;
}

TEST_F(DiagnosisOfRealRecording, NamesSlowCausesForAnyAveraging) {
  const std::filesystem::path run = means_of_the_adis16405().front();
  const std::vector<Diagnosis> seconds = diagnosis_of_all(run);
  const std::vector<Diagnosis> tenths =
      diagnosis_of_all(run.parent_path() / "run1_10hz_mean.csv.gz");
  const std::vector<Diagnosis> raw = diagnosis_of_all(run.parent_path() / "run1_100hz_raw.csv.gz");
  for (std::size_t axis = 0; axis < seconds.size(); ++axis) {
    EXPECT_THAT(slow_causes(seconds[axis]), Contains("fractional_order")) << axis;
    EXPECT_EQ(slow_causes(tenths[axis]), slow_causes(seconds[axis])) << axis;
    EXPECT_EQ(slow_causes(raw[axis]), slow_causes(seconds[axis])) << axis;
    // Fast causes where they can be seen.
    EXPECT_THAT(mentioned(raw[axis]), IsSupersetOf({"quantization", "sensor_bandwidth"})) << axis;
    EXPECT_THAT(mentioned(seconds[axis]), Not(Contains("sensor_bandwidth"))) << axis;
  }
}

}  // namespace
}  // namespace zerorate::diagnose

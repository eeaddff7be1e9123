#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "firmware/model/catalogue.hpp"
#include "host_tests/support/recordings_folder.hpp"
#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::evaluate {
namespace {

/// Geometric mean over runs, axes and eight schedules of kalman / calibration_mean heading drift.
double mean_ratio(const std::filesystem::path& folder, double still_s, double drive_s) {
  const ReplayOptions base{.model = model::find_model("adis16405")};
  double sum_of_logs = 0.0;
  int count = 0;
  for (int run = 1; run <= 3; ++run) {
    const auto file =
        folder / "adis16405_static" / ("run" + std::to_string(run) + "_1hz_mean_with_accel.csv.gz");
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      ReplayOptions options = base;
      options.schedule = ScheduleParams{.still_s = still_s, .drive_s = drive_s, .seed = seed};
      recording::Reader reader{file};
      const ReplayResult result = replay(reader, options);
      for (const auto& axis : result.scores) {
        sum_of_logs += std::log(axis[0].heading_drift_rms_rad() / axis[2].heading_drift_rms_rad());
        ++count;
      }
    }
  }
  return std::exp(sum_of_logs / count);
}

// The catalogue's model is from the data sheet: nothing is fitted to these recordings.
TEST(KalmanOnRealAdis16405, DriftsAtMostThreeQuartersOfTheCalibrationMean) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) {
    GTEST_SKIP() << "skipped: no recordings";
  }
  EXPECT_LE(mean_ratio(*folder, 15.0, 60.0), 0.75);
  EXPECT_LE(mean_ratio(*folder, 30.0, 120.0), 0.75);
}

}  // namespace
}  // namespace zerorate::evaluate

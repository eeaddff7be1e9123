// Recordings that join a population, and those that do not.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/fleet/analysis.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::fleet {
namespace {

using ::testing::HasSubstr;

/// A recording of one axis at 50 Hz for 80 s: a bias and normal noise of 0.05 deg/s.
/// @param factor  of the rates  @param stamp_step_s  resolution of the stamps
std::string recording_of(double factor, double stamp_step_s) {
  const random::RandomStream noise{31};
  std::string text = "t_s,rate_dps\n";
  for (std::int64_t k = 0; k < 4'000; ++k) {
    const double time_s = 0.02 * static_cast<double>(k) + 0.001;
    text += fmt::format("{:.3f},{:.9f}\n", stamp_step_s * std::floor(time_s / stamp_step_s),
                        factor * (0.4 + 0.05 * noise.normal(k)));
  }
  return text;
}

TEST(RecordingInDoubt, IsNoMemberUnlessAccepted) {
  const testing::ScratchFolder folder;
  recording::Input input{folder.write("radians.csv", recording_of(units::kRadPerDeg, 0.02))};
  try {
    static_cast<void>(read_population_samples(input));
    FAIL();
  } catch (const recording::DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--accept unit"));
  }
  input.accepted = "unit";
  EXPECT_EQ(analyse(read_population_samples(input)).problem(), "");
}

TEST(RecordingWithRepairedStamps, IsAMemberWithARemark) {
  const testing::ScratchFolder folder;
  const recording::Input even{folder.write("even.csv", recording_of(1.0, 0.02))};
  EXPECT_EQ(read_population_samples(even).rows_doubt, "");
  const recording::Input pairs{folder.write("pairs.csv", recording_of(1.0, 0.04))};
  const RecordingResult result = analyse(read_population_samples(pairs));
  EXPECT_THAT(result.problem(), HasSubstr("% of the rows were repaired"));
  EXPECT_EQ(result.axes.size(), 1U);
}

}  // namespace
}  // namespace zerorate::fleet

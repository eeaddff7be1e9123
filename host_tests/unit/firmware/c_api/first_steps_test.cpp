// The example at the top of zerorate.h, over all that a vehicle does to it.

#include "firmware/c_api/examples/first_steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>

#include "host_tests/unit/firmware/c_api/c_api_rig.hpp"

namespace zerorate::c_api::testing {
namespace {

std::uint64_t board_us = 0;

}  // namespace
}  // namespace zerorate::c_api::testing

const zerorate_model my_sensor = front_gyro;
std::uint32_t micros() {
  return static_cast<std::uint32_t>(zerorate::c_api::testing::board_us);
}

namespace zerorate::c_api {
namespace {

using testing::board_us;
using testing::Moment;
using testing::moment;

std::string text_of(const std::string& path) {
  std::ifstream file{std::string{ZERORATE_REPOSITORY} + "/firmware/c_api/" + path};
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string without_space(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n'; });
  return text;
}

/// The indented lines of the first comment.
std::string example_of_the_header() {
  std::istringstream header{text_of("include/zerorate.h")};
  std::string example;
  std::string line;
  while (std::getline(header, line) && line != " */") {
    if (line.starts_with(" *     ")) example += line.substr(2);
  }
  return without_space(example);
}

TEST(ExampleOfTheHeader, IsTheFileThatIsTested) {
  const std::string file = text_of("examples/first_steps.c");
  EXPECT_EQ(example_of_the_header(),
            without_space(file.substr(file.find("static zerorate_node gyro;"))));
}

/// Stops and curves, sample by sample at 100 Hz; words come ten times a second.
class FirstSteps : public ::testing::Test {
 protected:
  static constexpr float kCurve_rad_s = 0.1F;

  /// The counter wraps a minute after the start.
  void SetUp() override {
    board_us = (std::uint64_t{1} << 32U) - 60'000'000U;
    turn_rad = 0.0F;
    start_gyro();
  }

  void run(int samples, float turn_rad_s, bool has_bus) {
    for (int i = 0; i < samples; ++i, ++k_) {
      if (has_bus && i % 10 == 0) take_word(turn_rad_s == 0.0F);
      Moment now = moment(k_ % testing::kStopSamples);
      now.measured.rate_rad_s[2] += turn_rad_s;
      if (is_frozen_) now.measured.rate_rad_s[2] = 0.1F;
      take_sample(now.measured);
      board_us += 10'000;
    }
  }

  std::int64_t k_ = 0;
  bool is_frozen_ = false;
};

/// Noise of the samples and of the bias: far below a degree over these drives.
constexpr float kTolerance_rad = 0.02F;

TEST_F(FirstSteps, KeepTheTurnOverTheWrapOfTheCounter) {
  run(5000, 0.0F, true);
  run(2000, kCurve_rad_s, true);
  EXPECT_NEAR(turn_rad, 2.0F, kTolerance_rad);
  EXPECT_TRUE(is_trusted);
}

TEST_F(FirstSteps, DoNotTrustWhatTheScaleFactorMayHaveChanged) {
  run(5000, 0.0F, true);
  run(9000, kCurve_rad_s, true);
  EXPECT_FALSE(is_trusted);  // 1 % of 9 rad, at 95 %: 10 deg
}

TEST_F(FirstSteps, LearnNoCurveWhereTheBusIsDead) {
  run(6000, 0.0F, true);
  run(2000, kCurve_rad_s, false);
  EXPECT_NEAR(turn_rad, 2.0F, 2.0F * kTolerance_rad);
}

TEST_F(FirstSteps, LearnNothingWhereTheBusWasDeadFromTheStart) {
  run(12'000, kCurve_rad_s, false);
  EXPECT_EQ(turn_rad, 0.0F);
  EXPECT_FALSE(is_trusted);
}

TEST_F(FirstSteps, DoNotTrustAFrozenAxis) {
  run(6000, 0.0F, true);
  is_frozen_ = true;
  run(6000, kCurve_rad_s, true);
  EXPECT_FALSE(is_trusted);
  EXPECT_LT(std::abs(turn_rad), 0.2F);  // the first second or two of 0.1 rad/s
}

TEST_F(FirstSteps, SumNothingOfARateThatIsNone) {
  run(6000, 0.0F, true);
  zerorate_measurement broken = moment(0).measured;
  broken.rate_rad_s[2] = std::nanf("");
  take_sample(broken);
  EXPECT_FALSE(is_trusted);
  EXPECT_TRUE(std::isfinite(turn_rad));
}

}  // namespace
}  // namespace zerorate::c_api

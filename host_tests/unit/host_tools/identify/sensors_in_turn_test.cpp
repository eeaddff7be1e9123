#include "host_tools/lib/identify/sensors_in_turn.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>

namespace zerorate::identify {
namespace {

using ::testing::HasSubstr;

/// One axis of 40,000 rows with white noise of one unit, beside what the function of the row says;
/// a share of the rows is lost.
std::string complaint(const std::function<double(int)>& value, double lost = 0.0) {
  std::mt19937_64 random{41};
  std::normal_distribution<double> noise{0.0, 1.0};
  std::uniform_real_distribution<double> lottery{0.0, 1.0};
  RestSamples samples{.axis_count = 1, .sample_period = core::Duration::milliseconds(5)};
  for (int row = 0; row < 40'000; ++row) {
    const double rate = value(row) + noise(random);
    if (lottery(random) < lost) continue;
    samples.time.push_back(core::Instant::from_ns(row * std::int64_t{5'000'000}));
    samples.rate_rad_s.push_back({static_cast<float>(rate)});
  }
  return sensors_in_turn(samples).value_or("");
}

TEST(TwoSensorsInTurn, AreFoundDownToTheirNoise) {
  for (const double distance : {1.0, 3.0, 30.0}) {
    for (const double lost : {0.0, 0.1, 0.3}) {
      EXPECT_THAT(complaint([&](int row) { return row % 2 == 0 ? 0.0 : distance; }, lost),
                  HasSubstr("2 sensors in one file"))
          << distance << ", " << lost << " lost";
    }
  }
}

TEST(TwoSensorsInTurn, AreToldWithTheDistanceOfTheirLevels) {
  const std::string told = complaint([](int row) { return 2.0 * (row % 2); }, 0.2);
  const std::string before = "has a level of its own, ";
  ASSERT_THAT(told, HasSubstr(before));
  // Estimate from the changes of 32,000 rows, each with an error of its own size: a few percent.
  constexpr double kDistance_dps = 2.0 * 180.0 / std::numbers::pi;
  EXPECT_NEAR(std::stod(told.substr(told.find(before) + before.size())), kDistance_dps,
              0.1 * kDistance_dps);
}

TEST(ThreeSensorsInTurn, AreFound) {
  EXPECT_THAT(complaint([](int row) { return 3.0 * (row % 3); }),
              HasSubstr("3 sensors in one file"));
}

TEST(OneSensor, IsNotTakenForTwo) {
  EXPECT_EQ(complaint([](int) { return 0.0; }), "");
  EXPECT_EQ(complaint([](int row) { return 1e-4 * row; }), "") << "a drift";
  for (const double turns_a_sample : {0.3, 0.35, 0.4, 0.45, 0.48}) {
    for (const double amplitude : {0.5, 5.0}) {
      const auto tone = [&](int row) {
        return amplitude * std::sin(2.0 * std::numbers::pi * turns_a_sample * row);
      };
      EXPECT_EQ(complaint(tone), "") << "an engine, " << turns_a_sample << ", " << amplitude;
    }
  }
  // Differences of angles that are rounded: neighbours share a rounding error, with opposite signs.
  std::mt19937_64 random{42};
  std::uniform_real_distribution<double> error{-2.0, 2.0};
  double before = 0.0;
  EXPECT_EQ(complaint([&](int) {
              const double rounding = error(random);
              return rounding - std::exchange(before, rounding);
            }),
            "");
}

}  // namespace
}  // namespace zerorate::identify

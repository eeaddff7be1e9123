// The level of white noise by the spread of calm windows, and what it is learnt from.

#include "core/samples/white_level.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

namespace zerorate::core {
namespace {

constexpr Duration kTick = Duration::milliseconds(100);
constexpr float kModel = 4.0F;  ///< variance of a sample by the model
constexpr std::uint32_t kSamples = 10;
constexpr int kTicksOfWindow = 5;

/// A sensor at rest whose samples have a variance of their own.
struct Sensor {
  explicit Sensor(double variance, bool learns = true)
      : level(kModel, {}, kTick, learns), noise(0.0, std::sqrt(variance / kSamples)) {}

  void rest(int ticks, float bias = 0.0F) {
    for (int k = 0; k < ticks; ++k) {
      TickMean<3> mean{.tick = tick++, .samples = kSamples};
      for (float& rate : mean.rate_rad_s) rate = bias + static_cast<float>(noise(random));
      level.observe(mean);
    }
  }

  WhiteLevel<3> level;
  std::mt19937 random{7};
  std::normal_distribution<double> noise;
  std::uint32_t tick = 0;
};

// A spread on three axes has some three degrees of freedom, and 64 of them are averaged: the
// standard deviation is a tenth.
TEST(WhiteLevel, IsTheVarianceOfTheSamplesOverThatOfTheModel) {
  Sensor sensor{1.0};
  sensor.rest(5000);
  EXPECT_NEAR(sensor.level.level(), 0.25F, 0.08F);
  EXPECT_NEAR(sensor.level.shown_rad2_s2(), 1.0F, 0.32F);
}

TEST(WhiteLevel, IsKnownAfterHalfAMinuteOfWindows) {
  Sensor sensor{1.0};
  EXPECT_EQ(sensor.level.knowledge(), WhiteKnowledge::model);
  sensor.rest(3 * kTicksOfWindow);
  EXPECT_EQ(sensor.level.knowledge(), WhiteKnowledge::seen);
  sensor.rest(62 * kTicksOfWindow);
  EXPECT_EQ(sensor.level.knowledge(), WhiteKnowledge::seen);
  sensor.rest(kTicksOfWindow);
  EXPECT_EQ(sensor.level.knowledge(), WhiteKnowledge::known);
}

TEST(WhiteLevelThatIsNotLearnt, StaysThatOfTheModel) {
  Sensor sensor{1.0, false};
  sensor.rest(5000);
  EXPECT_EQ(sensor.level.level(), 1.0F);
  EXPECT_EQ(sensor.level.knowledge(), WhiteKnowledge::model);
}

// Three windows follow each other before they are compared.
TEST(WhiteLevelAfterAGap, DoesNotCompareTheBiasWithThatOfBefore) {
  Sensor sensor{1.0};
  sensor.rest(5000);
  const float before = sensor.level.shown_rad2_s2();
  for (const float bias : {100.0F, 0.0F}) {
    ++sensor.tick;
    sensor.rest(2 * kTicksOfWindow, bias);
    EXPECT_EQ(sensor.level.shown_rad2_s2(), before);
  }
}
TEST(WhiteLevelAfterAGap, BeginsAWindowAnew) {
  Sensor sensor{1.0};
  sensor.rest(5000 + kTicksOfWindow - 1);
  const float before = sensor.level.shown_rad2_s2();
  ++sensor.tick;
  sensor.rest(3 * kTicksOfWindow - 1, 100.0F);
  EXPECT_EQ(sensor.level.shown_rad2_s2(), before);
  sensor.rest(1, 100.0F);
  EXPECT_NE(sensor.level.shown_rad2_s2(), before);
  EXPECT_LT(sensor.level.shown_rad2_s2(), 2.0F * before);
}

TEST(WhiteLevelOfAJump, RisesEightfoldAtMost) {
  Sensor sensor{1.0};
  sensor.rest(5000);
  const float before = sensor.level.shown_rad2_s2();
  sensor.rest(kTicksOfWindow, 100.0F);
  EXPECT_NEAR(sensor.level.shown_rad2_s2(), before * (1.0F + 7.0F / 64.0F), 0.001F * before);
}

TEST(WhiteLevelOfDifferences, IsTheMeanOfTheirHalvedSquares) {
  Sensor sensor{1.0};
  for (int window = 0; window < 8; ++window) {
    sensor.level.observe_differences({20.0F, 40.0F, 60.0F}, 10);
  }
  // 120 / (2 x 3 x 10), below the model and so not below it in what is certain.
  EXPECT_FLOAT_EQ(sensor.level.state().local_rad2_s2, 2.0F);
}

TEST(ReferenceOfLearntFigures, FollowsTheLevelOnce) {
  Sensor sensor{1.0};
  EXPECT_FALSE(sensor.level.is_to_rebase());
  sensor.rest(5000);
  ASSERT_TRUE(sensor.level.is_to_rebase());
  const float level = sensor.level.level();
  EXPECT_FLOAT_EQ(sensor.level.rebase(), level);
  EXPECT_FALSE(sensor.level.is_to_rebase());
  EXPECT_EQ(sensor.level.reference(), level);
  EXPECT_EQ(sensor.level.scale_of_learnt(), level);
  EXPECT_EQ(sensor.level.change(), 1.0F);
  sensor.level.set_reference(level * 4.0F);
  EXPECT_FLOAT_EQ(sensor.level.change(), 0.25F);
}

}  // namespace
}  // namespace zerorate::core

#include "core/samples/sample_screen.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/samples/noise_level_track.hpp"
#include "core/samples/rounding_watch.hpp"
#include "core/samples/tick_average.hpp"

namespace zerorate::core {
namespace {

constexpr float kWhite = 4.0F;

double normal_density(double x, double variance) {
  return std::exp(-0.5 * x * x / variance) / std::sqrt(2.0 * std::numbers::pi * variance);
}

TEST(SampleScreenOfPlainNoise, HasTheBiasOfAKalmanFilter) {
  const SampleModel model;
  SampleScreen screen{model};
  screen.begin_tick(10.0F, 2.0F, kWhite);
  const double prior = 1.0 / 2.0;
  double sum = 0.0;
  for (int n = 1; n <= 5; ++n) {
    const float rate = 10.0F + static_cast<float>(n % 3);
    EXPECT_TRUE(screen.take(rate));
    sum += double{rate};
    // Precisions add: prior at 10, n samples of variance 4.
    const double precision = prior + n / 4.0;
    EXPECT_NEAR(double{screen.forecast().expected_rad_s}, (prior * 10.0 + sum / 4.0) / precision,
                1e-5);
    EXPECT_NEAR(double{screen.forecast().variance}, 1.0 / precision + 4.0, 1e-5);
  }
}

TEST(SampleScreenOfPlainNoise, EstimatesTheWhiteVariance) {
  constexpr int kTicks = 2000;
  constexpr int kSamples = 10;
  const SampleModel model;
  SampleScreen screen{model};
  std::mt19937 random{7};
  std::normal_distribution<float> normal;
  double sum = 0.0;
  for (int tick = 0; tick < kTicks; ++tick) {
    const float bias = normal(random);  // predicted variance: 1
    screen.begin_tick(0.0F, 1.0F, kWhite);
    for (int k = 0; k < kSamples; ++k) (void)screen.take(bias + 2.0F * normal(random));
    sum += double{screen.squares_rad2_s2()};
  }
  // A mean of 20,000 squares of variance 2 each: four standard errors.
  EXPECT_NEAR(sum / (kTicks * kSamples) / 4.0, 1.0, 4.0 * std::sqrt(2.0 / (kTicks * kSamples)));
}

TEST(SampleScreenBeforeACalibration, LearnsFromEverySample) {
  const SampleModel model{.outliers = {.probability = 1e-3F, .variance_rad2_s2 = 400.0F}};
  SampleScreen screen{model};
  EXPECT_TRUE(screen.take(1e6F));
  screen.begin_tick(0.0F, std::numeric_limits<float>::infinity(), kWhite);
  EXPECT_TRUE(screen.take(1e6F));
}

TEST(SampleScreenWithOutliers, LearnsFromASampleAsBayesRuleSays) {
  constexpr double kProbability = 1e-3;
  constexpr double kWild = 400.0;
  const SampleModel model{.outliers = {.probability = 1e-3F, .variance_rad2_s2 = 400.0F}};
  for (float rate = 0.0F; rate < 40.0F; rate += 0.25F) {
    SampleScreen screen{model};
    screen.begin_tick(0.0F, 1.0F, kWhite);
    const double good = (1.0 - kProbability) * normal_density(double{rate}, 5.0);
    const double bad = kProbability * normal_density(double{rate}, 5.0 + kWild);
    EXPECT_EQ(screen.take(rate), good >= bad) << rate;
  }
}

TEST(SampleScreenWithOutliers, KeepsNearlyAllOfPlainNoise) {
  constexpr int kSamples = 100'000;
  const SampleModel model{.outliers = {.probability = 1e-3F, .variance_rad2_s2 = 400.0F}};
  SampleScreen screen{model};
  std::mt19937 random{3};
  std::normal_distribution<float> normal;
  int refused = 0;
  for (int k = 0; k < kSamples; ++k) {
    screen.begin_tick(0.0F, 1e-3F, kWhite);
    if (!screen.take(2.0F * normal(random))) ++refused;
  }
  // Refused is what is likelier an outlier, so rarer than one by the model: at most p of them.
  EXPECT_LT(refused, 100 + 4 * 10);
}

/// A rotation of 20 samples on average, once in a thousand.
constexpr SampleModel kMotion{
    .motion = {.begin_probability = 1e-3F, .end_probability = 0.05F, .variance_rad2_s2 = 100.0F}};

TEST(SampleScreenDuringARotation, LearnsAfterItOnly) {
  SampleScreen screen{kMotion};
  std::mt19937 random{5};
  std::normal_distribution<float> normal;
  int learnt_inside = 0;
  int learnt_outside = 0;
  for (int k = 0; k < 300; ++k) {
    if (k % 10 == 0) screen.begin_tick(0.0F, 0.01F, kWhite);
    const bool inside = k >= 100 && k < 120;
    const bool learnt = screen.take((inside ? 15.0F : 0.0F) + 2.0F * normal(random));
    (inside ? learnt_inside : learnt_outside) += learnt ? 1 : 0;
  }
  EXPECT_LE(learnt_inside, 1);
  EXPECT_GE(learnt_outside, 275);  // until it is certain that it is over, a few are not
}

TEST(SampleScreenAfterAJumpOfTheBias, LearnsAfterTheRotationTime) {
  SampleScreen screen{kMotion};
  int refused = 0;
  for (int k = 0; k < 1000; ++k) {
    if (k % 10 == 0) screen.begin_tick(0.0F, 0.01F, kWhite);
    if (!screen.take(30.0F)) ++refused;
  }
  // Steps of a twentieth that make up sixteen; single precision may round to one fewer.
  EXPECT_NEAR(refused, 16 * 20, 1);
}

TEST(SampleScreenAtTheEndOfAStop, ForgetsTheRotation) {
  SampleScreen screen{kMotion};
  screen.begin_tick(0.0F, 0.01F, kWhite);
  for (int k = 0; k < 10; ++k) (void)screen.take(30.0F);
  EXPECT_GT(screen.forecast().moved, 0.5F);
  screen.end_stop();
  EXPECT_LT(screen.forecast().moved, 0.01F);
}

TEST(NoiseLevelTrack, FollowsAStepAndForgetsItOverAGap) {
  const NoiseLevel model{.variance = 1.0F, .time_constants_per_tick = 1e-3F};
  NoiseLevelTrack track{model};
  for (int k = 0; k < 2000; ++k) {
    track.advance(1);
    track.observe(2.0F, 10.0F);
  }
  // In the steady state it moves towards the mean of the model by far less than to the measured.
  EXPECT_NEAR(track.level(), 2.0F, 0.05F);
  track.advance(10'000);  // ten time constants
  EXPECT_NEAR(track.level(), 1.0F, 1e-3F);
}

TEST(NoiseLevelTrackOfAConstantStrength, StaysWhereItIs) {
  const NoiseLevel model;
  NoiseLevelTrack track{model};
  track.advance(1);
  track.observe(100.0F, 10.0F);
  EXPECT_EQ(track.level(), 1.0F);
}

TEST(NoiseLevelTrackOfNearlySilence, StaysPositive) {
  const NoiseLevel model{.variance = 10.0F, .time_constants_per_tick = 1e-3F};
  NoiseLevelTrack track{model};
  for (int k = 0; k < 100; ++k) {
    track.advance(1);
    track.observe(1e-6F, 10.0F);
    EXPECT_GT(track.level(), 0.0F);
  }
}

constexpr Duration kTick = Duration::milliseconds(100);
constexpr Duration kSample = Duration::milliseconds(10);

/// Feeds samples at these times and returns the means of the ticks they were sorted into.
std::vector<TickMean<1>> means_of(const std::vector<std::pair<Instant, float>>& samples) {
  TickAverage<1> average{kTick, kSample};
  std::vector<TickMean<1>> means;
  for (const auto& [at, rate] : samples) {
    if (average.is_over_at(at) && !average.is_empty()) means.push_back(average.close());
    average.enter(at);
    average.add(at, {rate});
  }
  return means;
}

TEST(TickAverage, MeansTheSamplesOfEachTick) {
  std::vector<std::pair<Instant, float>> samples;
  for (int k = 0; k < 30; ++k) {
    samples.emplace_back(Instant{} + kSample * k, static_cast<float>(k));
  }
  const auto means = means_of(samples);
  ASSERT_EQ(means.size(), 2U);
  EXPECT_EQ(means[0].samples, 10U);
  EXPECT_FLOAT_EQ(means[0].rate_rad_s[0], 4.5F);
  EXPECT_FLOAT_EQ(means[1].rate_rad_s[0], 14.5F);
  EXPECT_EQ(means[1].tick, 1U);
  EXPECT_EQ(means[1].end, Instant{} + kSample * 19);
}

/// Verifies SR-TIME-01.
TEST(TickAverageWithJitter, StillGivesEverySampleItsTick) {
  std::mt19937 random(9);
  std::uniform_int_distribution<std::int64_t> jitter_ns(-4'900'000, 4'900'000);
  std::vector<std::pair<Instant, float>> samples;
  for (int k = 0; k < 1001; ++k) {
    samples.emplace_back(
        Instant{} + kSample * k + Duration::nanoseconds(k == 0 ? 0 : jitter_ns(random)), 1.0F);
  }
  for (const auto& mean : means_of(samples)) EXPECT_EQ(mean.samples, 10U);
}

// 24.8 days of ticks of a millisecond; docs/reference/zerorated.md tells it of filter.rate_hz.
TEST(TickAverageOfMoreTicksThanACounterHolds, TakesNoFurtherSample) {
  constexpr Duration kMillisecond = Duration::milliseconds(1);
  TickAverage<1> average{kMillisecond, kMillisecond};
  average.enter(Instant{});
  constexpr std::int64_t kTicks = std::int64_t{1} << 31U;
  EXPECT_TRUE(average.can_take(Instant{} + kMillisecond * (kTicks - 1)));
  EXPECT_FALSE(average.can_take(Instant{} + kMillisecond * kTicks));
}

TEST(TickAverageWithAGap, NumbersTheNextTickByTheClock) {
  const auto means = means_of({{Instant{}, 1.0F},
                               {Instant{} + Duration::seconds(3600), 2.0F},
                               {Instant{} + Duration::seconds(3601), 3.0F}});
  ASSERT_EQ(means.size(), 2U);
  EXPECT_EQ(means[1].tick, 36'000U);
}

TEST(TickAverageUnderALargeRate, KeepsTheSmallDifferences) {
  const float one_ulp_more = std::nextafter(4.0F, 5.0F);
  std::vector<std::pair<Instant, float>> samples;
  for (int k = 0; k < 200; ++k) samples.emplace_back(Instant{} + kSample * k, one_ulp_more);
  for (const auto& mean : means_of(samples)) EXPECT_EQ(mean.rate_rad_s[0], one_ulp_more);
}

TEST(TickAverageGivenTimesItCannotCount, SaysSo) {
  TickAverage<1> average{kTick, kSample};
  EXPECT_TRUE(average.can_take(Instant::from_ns(-1)));
  average.enter(Instant{});
  EXPECT_FALSE(average.can_take(Instant::from_ns(-1'000'000'000)));
  EXPECT_FALSE(average.can_take(Instant{} + Duration::seconds(8LL * 365 * 86'400)));
}

// The reference is the mean of the rounded normal number itself, at 200 places within a step.
TEST(RoundingVariance, IsThatOfTheErrorOfTheMean) {
  for (const double sigma : {0.05, 0.1, 0.2, 0.3, 0.5}) {
    double squares = 0.0;
    for (int place = 0; place < 200; ++place) {
      const double x = (static_cast<double>(place) + 0.5) / 200.0;
      double mean = 0.0;
      for (int level = -5; level <= 6; ++level) {
        const auto below = [&](double border) {
          return 0.5 * std::erfc((x - border) / (sigma * std::numbers::sqrt2));
        };
        mean += level * (below(level + 0.5) - below(level - 0.5));
      }
      squares += (mean - x) * (mean - x) / 200.0;
    }
    const auto noise = static_cast<float>(sigma * sigma);
    EXPECT_NEAR(double{rounding_variance(1.0F, noise)}, squares, 0.01 * squares + 1e-7) << sigma;
    EXPECT_FLOAT_EQ(rounding_variance(2.0F, 4.0F * noise), 4.0F * rounding_variance(1.0F, noise));
  }
  EXPECT_NEAR(double{rounding_variance(1.0F, 0.0F)}, 1.0 / 12.0, 1e-6);
  EXPECT_EQ(rounding_variance(1.0F, 1.0F), 0.0F);
  EXPECT_EQ(rounding_variance(0.0F, 1.0F), 0.0F);
}

/// Windows of fifty rounded samples at rest.
RoundingWatch<1> watch_of_rest(const Rounding& model, float white, float rate, float sigma) {
  RoundingWatch<1> watch{model, white};
  std::mt19937 random(3);
  std::normal_distribution<float> noise{rate, sigma};
  for (int window = 0; window < 64; ++window) {
    RoundingWatch<1>::Rates squares{};
    float before = std::round(noise(random));
    watch.take({before});
    for (int k = 0; k < 50; ++k) {
      const float sample = std::round(noise(random));
      watch.take({sample});
      squares[0] += (sample - before) * (sample - before);
      before = sample;
    }
    watch.observe(squares, 50);
  }
  return watch;
}

TEST(RoundingWatch, SeesTheStepOfNoisySamples) {
  EXPECT_EQ(watch_of_rest({}, 1.0F, 0.3F, 1.0F).step_rad_s(), 1.0F);
  EXPECT_EQ(watch_of_rest({}, 1.0F, 0.0F, 0.01F).step_rad_s(), 0.0F);
}
TEST(RoundingWatch, KeepsItsStepThroughSamplesWithAFlippedBit) {
  RoundingWatch<1> watch = watch_of_rest({}, 0.01F, 0.3F, 0.1F);
  ASSERT_EQ(watch.step_rad_s(), 1.0F);
  for (const float sample : {0.0F, 0.125F, 0.0F, 0.0F, 1.0F, 1.125F, 1.0F, 1.0F}) {
    watch.take({sample});
  }
  EXPECT_EQ(watch.step_rad_s(), 1.0F);
}
// Changes by many steps come first, and those by one step sooner or later.
TEST(RoundingWatchOfManySteps, FindsTheSmallestWithinSeconds) {
  RoundingWatch<1> watch{{}, 100.0F};
  std::mt19937 random(6);
  std::normal_distribution<float> noise{0.0F, 10.0F};
  for (int k = 0; k < 1000; ++k) watch.take({std::round(noise(random))});
  EXPECT_EQ(watch.step_rad_s(), 1.0F);
}
TEST(RoundingWatchOfNoiseBeyondAStep, AddsNothing) {
  EXPECT_EQ(watch_of_rest({}, 1.0F, 0.3F, 1.0F).variance_rad2_s2(0), 0.0F);
}
// The mean of the samples is 0.0228, that of the rate 0.3.
/// Verifies SR-INT-10.
TEST(RoundingWatchOfLittleNoise, CoversTheErrorUnderAnyModel) {
  for (const float white : {0.01F, 0.04F, 1.0F}) {
    const float sigma = std::sqrt(watch_of_rest({}, white, 0.3F, 0.1F).variance_rad2_s2(0));
    EXPECT_GT(2.0F * sigma, 0.3F - 0.0228F);
    EXPECT_LT(sigma, 0.3F);
  }
}
TEST(RoundingWatchOfSamplesWithoutChange, CountsTheNoiseAsHidden) {
  constexpr float kWhiteOfModel = 0.01F;
  const auto watch = watch_of_rest({}, kWhiteOfModel, 0.0F, 0.01F);
  EXPECT_NEAR(watch.variance_rad2_s2(0), 100.0F * kWhiteOfModel / 12.0F, 1e-5F);
}
TEST(RoundingWatchUnderAModelWithAStep, TakesTheLargerStep) {
  EXPECT_EQ(watch_of_rest({.step_rad_s = 3.0F}, 1.0F, 0.3F, 1.0F).step_rad_s(), 3.0F);
  EXPECT_EQ(watch_of_rest({.step_rad_s = 0.1F}, 1.0F, 0.3F, 1.0F).step_rad_s(), 1.0F);
  const Rounding model{.step_rad_s = 0.1F, .floor_rad2_s2 = 0.25F};
  EXPECT_EQ((RoundingWatch<1>{model, 1.0F}.variance_rad2_s2(0)), 0.25F);
}

}  // namespace
}  // namespace zerorate::core

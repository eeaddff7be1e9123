#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::simulate {
namespace {

Signal simulated(std::size_t samples, double period_s, std::vector<Effect> effects) {
  return simulate(Signal(samples, period_s), effects, random::RandomStream(20120416));
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double autocovariance(const std::vector<double>& values, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t k = lag; k < values.size(); ++k) sum += values[k] * values[k - lag];
  return sum / static_cast<double>(values.size() - lag);
}

TEST(Simulation, AddsEffectsWithoutDisturbingTheOthersNumbers) {
  const WhiteNoise white{1.0};
  const Outliers outliers{5.0, 0.1};
  const auto alone = simulated(100, 0.1, {white}).rate_rad_s;
  const auto other = simulated(100, 0.1, {outliers}).rate_rad_s;
  const auto both = simulated(100, 0.1, {outliers, white}).rate_rad_s;
  for (std::size_t k = 0; k < both.size(); ++k) EXPECT_EQ(both[k], alone[k] + other[k]);
}

TEST(Simulation, GivesEqualEffectsDifferentNumbers) {
  const WhiteNoise white{1.0};
  const auto once = simulated(1, 1.0, {white}).rate_rad_s;
  const auto twice = simulated(1, 1.0, {white, white}).rate_rad_s;
  EXPECT_NE(twice[0], 2.0 * once[0]);
}

TEST(Simulation, OfNothingIsSilence) {
  const Signal signal = simulated(10, 0.5, {});
  EXPECT_EQ(signal.rate_rad_s, std::vector<double>(10));
  EXPECT_EQ(signal.time_s(4), 2.0);
}

// The mean square of n normals has relative variance 2/n.
TEST(WhiteNoise, HasTheVarianceOfItsDensity) {
  constexpr std::size_t kSamples = 100'000;
  const auto rate = simulated(kSamples, 0.01, {WhiteNoise{0.3}}).rate_rad_s;
  const double variance = 0.3 * 0.3 / 0.01;
  EXPECT_NEAR(autocovariance(rate, 0), variance, 5.0 * variance * std::sqrt(2.0 / kSamples));
}

TEST(FlickerNoise, StartsDifferInThePastOnly) {
  const auto zero = simulated(2000, 1.0, {FlickerNoise{1.0, 0.5, 0.0}}).rate_rad_s;
  const auto old = simulated(2000, 1.0, {FlickerNoise{1.0, 0.5, 8.0}}).rate_rad_s;
  // The past's share sum_{j>k} psi_j w_{k-j} is smooth: its step from sample to sample is of the
  // order 0.2 / k, 0.01 as much in the late sum as in the early one.
  double early = 0.0;
  double late = 0.0;
  for (std::size_t k = 1; k < 100; ++k)
    early += std::abs(old[k] - zero[k] - old[k - 1] + zero[k - 1]);
  for (std::size_t k = 1901; k < 2000; ++k)
    late += std::abs(old[k] - zero[k] - old[k - 1] + zero[k - 1]);
  EXPECT_NE(early, 0.0);
  EXPECT_LT(late, 0.05 * early);
}

TEST(FlickerNoise, OfOrderZeroIsWhiteAndOfOrderOneAlmostAWalk) {
  const auto white = simulated(500, 1.0, {FlickerNoise{1.0, 0.0, 0.0}}).rate_rad_s;
  const auto walk = simulated(500, 1.0, {FlickerNoise{1.0, 1.0, 0.0}}).rate_rad_s;
  for (std::size_t k = 1; k < 500; ++k) EXPECT_NEAR(walk[k] - walk[k - 1], white[k], 1e-12);
}

TEST(RateRandomWalk, HasIndependentStepsOfItsStrength) {
  constexpr std::size_t kSamples = 100'000;
  auto steps = simulated(kSamples, 0.04, {RateRandomWalk{0.5}}).rate_rad_s;
  EXPECT_EQ(steps[0], 0.0);
  std::adjacent_difference(steps.begin(), steps.end(), steps.begin());
  const double variance = 0.5 * 0.5 * 0.04;
  const double error = 5.0 * variance * std::sqrt(2.0 / kSamples);
  EXPECT_NEAR(autocovariance(steps, 0), variance, error);
  EXPECT_NEAR(autocovariance(steps, 1), 0.0, error);
}

// Sample autocovariance of n samples correlated over tau: about n / (2 tau) are independent.
TEST(CorrelatedNoise, DecaysExponentially) {
  constexpr std::size_t kSamples = 400'000;
  const auto rate = simulated(kSamples, 0.1, {CorrelatedNoise{2.0, 1.0}}).rate_rad_s;
  const double error = 5.0 * 4.0 * std::sqrt(2.0 * 20.0 / kSamples);
  for (const std::size_t lag : {0U, 5U, 10U, 20U}) {
    EXPECT_NEAR(autocovariance(rate, lag), 4.0 * std::exp(-0.1 * static_cast<double>(lag)), error);
  }
}

TEST(DeterministicEffects, HaveTheirClosedForms) {
  const double t = 30 * 0.5;
  const auto at_30 = [](Effect effect) { return simulated(100, 0.5, {effect}).rate_rad_s[30]; };
  EXPECT_DOUBLE_EQ(at_30(ConstantBias{0.2}), 0.2);
  EXPECT_DOUBLE_EQ(at_30(RateRamp{0.2}), 0.2 * t);
  EXPECT_DOUBLE_EQ(at_30(WarmUpTransient{2.0, 7.0}), 2.0 * std::exp(-t / 7.0));
  EXPECT_NEAR(at_30(PeriodicDisturbance{2.0, 0.3, 0.4}),
              2.0 * std::sin(2.0 * std::numbers::pi * 0.3 * t + 0.4), 1e-14);
  EXPECT_EQ(at_30(BiasJump{2.0, t}), 2.0);
  EXPECT_EQ(at_30(BiasJump{2.0, t + 0.1}), 0.0);
}

// n T / 4 s independent samples count for the occupancy, with a correlation time of 1/rate = 2 s.
TEST(RandomTelegraphNoise, DwellsAtItsTwoLevelsOnly) {
  constexpr std::size_t kSamples = 500'000;
  const auto rate = simulated(kSamples, 0.01, {RandomTelegraphNoise{1.0, 6.0, 3.0}}).rate_rad_s;
  int switches = 0;
  for (std::size_t k = 0; k < rate.size(); ++k) {
    EXPECT_TRUE(rate[k] == 0.0 || rate[k] == 1.0);
    if (k > 0 && rate[k] != rate[k - 1]) ++switches;
  }
  EXPECT_NEAR(mean_of(rate), 3.0 / 9.0, 5.0 * std::sqrt(2.0 / 9.0 * 4.0 / (0.01 * kSamples)));
  const double expected = 2.0 * 0.01 * kSamples / 9.0;  // one up and one down in 9 s
  EXPECT_NEAR(switches, expected, 5.0 * std::sqrt(expected));
}

TEST(TemperatureDrift, FollowsTheTemperatureWithItsLag) {
  Signal signal(1000, 0.1);
  signal.temperature_degc.assign(1000, 35.0);
  signal.temperature_degc[0] = 25.0;
  const std::vector<Effect> effects{TemperatureDrift{0.01, 0.001, 25.0, 5.0}};
  const Signal drifted = simulate(signal, effects, random::RandomStream(1));
  const double excess = 10.0 * (1.0 - std::exp(-0.1 * 300 / 5.0));
  EXPECT_EQ(drifted.rate_rad_s[0], 0.0);
  EXPECT_NEAR(drifted.rate_rad_s[300], 0.01 * excess + 0.001 * excess * excess, 1e-13);
}

TEST(TemperatureDrift, NeedsATemperature) {
  EXPECT_THROW((void)simulated(10, 1.0, {TemperatureDrift{0.01}}), std::invalid_argument);
}

TEST(Saturation, LimitsWhatCameBefore) {
  const auto rate = simulated(3, 1.0, {RateRamp{-1.0}, Saturation{1.5}}).rate_rad_s;
  EXPECT_EQ(rate, (std::vector<double>{0.0, -1.0, -1.5}));
}

TEST(Quantization, RoundsWhatCameBefore) {
  const auto rate = simulated(4, 1.0, {RateRamp{0.3}, Quantization{0.25}}).rate_rad_s;
  EXPECT_EQ(rate, (std::vector<double>{0.0, 0.25, 0.5, 1.0}));
}

TEST(SensorBandwidth, AnswersAStepExponentially) {
  const auto rate = simulated(50, 0.001, {BiasJump{1.0, 0.001}, SensorBandwidth{10.0}}).rate_rad_s;
  for (std::size_t k = 0; k < rate.size(); ++k) {
    const double t = 0.001 * static_cast<double>(k);
    EXPECT_NEAR(rate[k], -std::expm1(-2.0 * std::numbers::pi * 10.0 * t), 1e-13);
  }
}

TEST(Outliers, HitTheirShareOfTheSamples) {
  constexpr std::size_t kSamples = 100'000;
  const auto rate = simulated(kSamples, 1.0, {Outliers{3.0, 0.01}}).rate_rad_s;
  const auto clean = std::count(rate.begin(), rate.end(), 0.0);
  const double hits = static_cast<double>(kSamples) - static_cast<double>(clean);
  EXPECT_NEAR(hits, 1000.0, 5.0 * std::sqrt(1000.0));
}

// Losses make up p / (p + 1/run) of a two-state chain; a run of losses counts as one draw.
TEST(DroppedSamples, AreLostInRunsAndKeepTheTruth) {
  constexpr std::size_t kSamples = 200'000;
  const Signal signal = simulated(kSamples, 1.0, {RateRamp{1.0}, DroppedSamples{0.01, 4.0}});
  const auto lost = std::count(signal.missing.begin(), signal.missing.end(), true);
  const double share = 0.01 / (0.01 + 0.25);
  const double error = std::sqrt(share * 2.0 * 4.0 / kSamples);
  EXPECT_NEAR(static_cast<double>(lost) / kSamples, share, 5.0 * error);
  EXPECT_EQ(signal.rate_rad_s[777], 777.0);
}

TEST(MotionContamination, KnocksForItsDurationOnly) {
  const auto rate = simulated(100'000, 0.1, {MotionContamination{1.0, 100.0, 1.0}}).rate_rad_s;
  const auto still = std::count(rate.begin(), rate.end(), 0.0);
  const double moving = static_cast<double>(rate.size()) - static_cast<double>(still);
  // 100 knocks of 10 samples expected, Poisson.
  EXPECT_NEAR(moving, 1000.0, 5.0 * std::sqrt(100.0) * 10.0);
}

TEST(VariableNoise, IsStrongestInTheMiddleOfItsSwing) {
  constexpr std::size_t kSamples = 100'000;
  const auto rate = simulated(kSamples, 1.0, {VariableNoise{1.0, kSamples}}).rate_rad_s;
  const auto power = [&](std::size_t first) {
    double sum = 0.0;
    for (std::size_t k = first; k < first + 10'000; ++k) sum += rate[k] * rate[k];
    return sum / 10'000;
  };
  EXPECT_LT(power(0), 0.05);                                         // pi^2 / 300 = 0.033
  EXPECT_NEAR(power(45'000), 0.992, 5.0 * std::sqrt(2.0 / 10'000));  // 1 - pi^2 / 1200
}

}  // namespace
}  // namespace zerorate::simulate

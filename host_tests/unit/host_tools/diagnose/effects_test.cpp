#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::diagnose {
namespace {

using zerorate::testing::kRadPerDeg;

constexpr std::size_t kSamples = 10'000;
constexpr double kPeriod = 0.1;

/// An effect so strong that it must be named, and one of its figures.
struct Case {
  simulate::Effect effect;
  std::string parameter;
  double value;
  double relative_tolerance;  ///< half width of the effect's own interval at this length
};

void PrintTo(const Case& example, std::ostream* out) {
  *out << simulate::name(example.effect);
}

/// The white noise of a sample is 0.04 / sqrt(0.1) = 0.126 deg/s.
const std::vector<Case>& cases() {
  static const std::vector<Case> all{
      {simulate::RateRandomWalk{8e-3 * kRadPerDeg}, "coefficient_dps_per_sqrt_s", 8e-3, 0.3},
      {simulate::CorrelatedNoise{0.06 * kRadPerDeg, 2.0}, "time_constant_s", 2.0, 0.5},
      {simulate::SensorBandwidth{1.0}, "cut_off_hz", 1.0, 0.1},
      {simulate::RateRamp{3e-4 * kRadPerDeg}, "slope_dps_per_s", 3e-4, 0.2},
      {simulate::WarmUpTransient{0.2 * kRadPerDeg, 60.0}, "time_constant_s", 60.0, 0.4},
      {simulate::PeriodicDisturbance{0.02 * kRadPerDeg, 0.7}, "frequency_hz", 0.7, 1e-3},
      {simulate::Quantization{0.1 * kRadPerDeg}, "step_dps", 0.1, 1e-3},
      {simulate::BiasJump{0.08 * kRadPerDeg, 400.0}, "time_s", 400.0, 0.02},
      {simulate::Outliers{1.0 * kRadPerDeg, 3e-3}, "sigma_dps", 1.0, 0.4},
      {simulate::DroppedSamples{0.01, 2.0}, "mean_run_samples", 2.0, 0.3},
      {simulate::Saturation{0.4 * kRadPerDeg}, "upper_end_dps", 0.4, 1e-3},
      {simulate::MotionContamination{1.5 * kRadPerDeg, 200.0, 2.0}, "duration_s", 2.0, 0.6},
      {simulate::VariableNoise{0.08 * kRadPerDeg, 400.0}, "swing_period_s", 400.0, 0.1},
      {simulate::RandomTelegraphNoise{0.2 * kRadPerDeg, 40.0, 40.0}, "height_dps", 0.2, 0.2},
  };
  return all;
}

class StrongEffect : public ::testing::TestWithParam<Case> {};

TEST_P(StrongEffect, IsTheFirstCauseAndItsFigureIsRight) {
  const Case& example = GetParam();
  const std::vector<simulate::Effect> effects{
      simulate::ConstantBias{0.3 * kRadPerDeg}, simulate::WhiteNoise{0.04 * kRadPerDeg},
      simulate::FlickerNoise{15.0 / 3600.0 * kRadPerDeg, 0.5}, example.effect};
  const simulate::Signal signal =
      simulate::simulate(simulate::Signal(kSamples, kPeriod), effects, random::RandomStream(5));
  const Diagnosis diagnosis =
      diagnose(record_of(zerorate::testing::rest_samples_of(signal), 0), {.holdout = 0.0});

  ASSERT_FALSE(diagnosis.causes.empty());
  EXPECT_EQ(diagnosis.causes.front().effect, simulate::name(example.effect));
  for (const Parameter& parameter : diagnosis.causes.front().parameters) {
    EXPECT_LE(parameter.lo, parameter.value) << parameter.name;
    EXPECT_GE(parameter.hi, parameter.value) << parameter.name;
    if (parameter.name != example.parameter) continue;
    EXPECT_NEAR(parameter.value, example.value, example.relative_tolerance * example.value);
    return;
  }
  ADD_FAILURE() << "no parameter " << example.parameter;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, StrongEffect, ::testing::ValuesIn(cases()),
                         [](const auto& example) {
                           return std::string(simulate::name(example.param.effect));
                         });

// A rotation that loses its phase, by the definition of the process and not by its spectrum.
TEST(LineWhosePhaseWanders, IsAPeriodicDisturbanceWithItsWidth) {
  constexpr double kFrequency = 1.3;
  constexpr double kCoherence = 20.0;
  constexpr double kRms = 0.03 * kRadPerDeg;
  constexpr double kWhite = 0.1 * kRadPerDeg;
  EvenSeries series{.period_s = kPeriod, .rate_rad_s = std::vector<double>(2 * kSamples)};
  series.lost.resize(series.rate_rad_s.size());
  const random::RandomStream noise(23);
  const std::complex<double> turn =
      std::polar(std::exp(-kPeriod / kCoherence), 2.0 * std::numbers::pi * kFrequency * kPeriod);
  const double driven = kRms * std::sqrt(1.0 - std::norm(turn));
  std::complex<double> phasor = kRms;
  for (std::size_t k = 0; k < series.rate_rad_s.size(); ++k) {
    const auto at = static_cast<std::int64_t>(3 * k);
    series.rate_rad_s[k] = phasor.real() + kWhite * noise.normal(at);
    phasor = phasor * turn + driven * std::complex(noise.normal(at + 1), noise.normal(at + 2));
  }
  const FitData data(series, 1);
  const auto effect = make_periodic_disturbance();
  const Hypothesis without(data, {});
  const auto candidate = effect->examine(without);
  ASSERT_TRUE(candidate.has_value());
  EXPECT_GT(candidate->surprisal_nats, kSelectionThreshold_nats);
  const Hypothesis with(data, {candidate->part}, &without);
  const std::vector<Parameter> parameters = effect->describe({with, 0}).parameters;
  const std::array<double, 3> truth{std::numbers::sqrt2 * kRms / kRadPerDeg, kFrequency,
                                    kCoherence};
  ASSERT_EQ(parameters.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    // Half the interval is 1.96 standard errors: three of them.
    const double reach = 3.0 / 3.92 * (parameters[i].hi - parameters[i].lo);
    EXPECT_NEAR(parameters[i].value, truth[i], reach) << parameters[i].name;
  }
}

// Blocks leave a thousand of these values over, whose variance is another by chance: that must not
// count as a change of strength.
TEST(VariableNoiseInPlainWhiteNoise, NeedsBlocksOverTheRecord) {
  constexpr std::size_t kLength = 66'000;
  for (const std::uint64_t run : {1U, 2U, 3U, 4U}) {
    EvenSeries series{.period_s = 0.1, .rate_rad_s = std::vector<double>(kLength)};
    series.lost.resize(kLength);
    random::RandomStream(17, run).fill_normal(0, series.rate_rad_s);
    const FitData data(series, 1);
    const auto candidate = make_variable_noise()->examine(Hypothesis(data, {}));
    EXPECT_TRUE(!candidate || candidate->surprisal_nats < kSelectionThreshold_nats) << run;
  }
}

// Changes at any moment, stretches and swings of any length are looked at: all that is paid for.
TEST(VariableNoiseInPlainWhiteNoise, HasAnHonestSurprisal) {
  constexpr std::size_t kLength = 4096;
  constexpr std::uint64_t kRuns = 300;
  constexpr double kNats = 3.0;
  int count = 0;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    EvenSeries series{.period_s = 0.1, .rate_rad_s = std::vector<double>(kLength)};
    series.lost.resize(kLength);
    random::RandomStream(29, run).fill_normal(0, series.rate_rad_s);
    const FitData data(series, 1);
    const auto candidate = make_variable_noise()->examine(Hypothesis(data, {}));
    if (candidate && candidate->surprisal_nats > kNats) ++count;
  }
  // Poisson of mean 300 e^-3 = 14.9 at most: more than 28 have a probability of 6e-4.
  EXPECT_LE(count, 28);
}

// A tenth of the values is bridged; as residuals of nothing they would make the rest look wild.
TEST(OutliersInPlainWhiteNoise, AreNotFoundWhereManyValuesAreLost) {
  constexpr std::size_t kLength = 20'000;
  EvenSeries series{.period_s = 0.1, .rate_rad_s = std::vector<double>(kLength)};
  series.lost.resize(kLength);
  random::RandomStream(19).fill_normal(0, series.rate_rad_s);
  for (std::size_t k = 50; k < kLength; k += 70) {
    for (std::size_t i = 0; i < 7; ++i) series.lost[k + i] = true;
  }
  const FitData data(series, 1);
  const auto candidate = make_outliers()->examine(Hypothesis(data, {}));
  EXPECT_TRUE(!candidate || candidate->surprisal_nats < 3.0);
}

TEST(Catalogue, HasEighteenEffectsOfDifferentNames) {
  std::vector<std::string> names;
  for (const auto make : kEffects) names.emplace_back(make()->name());
  std::ranges::sort(names);
  EXPECT_EQ(names.size(), 18U);
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

}  // namespace
}  // namespace zerorate::diagnose

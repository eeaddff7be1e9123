#include "host_tools/lib/diagnose/adequacy/adequacy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"
#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::diagnose {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kSamples = 8192;

EvenSeries series_of(std::vector<double> values) {
  EvenSeries series{.period_s = 0.1, .rate_rad_s = std::move(values)};
  series.lost.resize(series.size());
  return series;
}

std::vector<double> white(std::uint64_t run) {
  std::vector<double> values(kSamples);
  random::RandomStream(3, run).fill_normal(0, values);
  return values;
}

Adequacy adequacy_of(std::vector<double> values) {
  const EvenSeries series = series_of(std::move(values));
  const FitData data(series, 1);
  return examine_adequacy(Hypothesis(data, {}));
}

TEST(AdequacyOfWhiteNoise, HoldsButForOneRecordInAHundred) {
  constexpr int kRuns = 60;
  int failures = 0;
  for (int run = 0; run < kRuns; ++run) {
    failures += adequacy_of(white(static_cast<std::uint64_t>(run))).holds ? 0 : 1;
  }
  // Poisson of mean 0.6: more than four have a probability below 1e-3.
  EXPECT_LE(failures, 4);
}

TEST(AdequacyWithSkewedNoise, FailsAndSaysSo) {
  std::vector<double> values = white(1);
  for (double& value : values) value = value + 0.15 * (value * value - 1.0);
  EXPECT_THAT(adequacy_of(values).failures, Contains(HasSubstr("skewed")));
}

TEST(AdequacyWithASweep, FailsAndSaysSo) {
  std::vector<double> values = white(2);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double share = static_cast<double>(k) / kSamples;
    values[k] += 0.25 * std::cos(2.0 * std::numbers::pi * (500.0 + 400.0 * share) * share);
  }
  EXPECT_THAT(adequacy_of(values).failures, Contains(HasSubstr("tone moves")));
}

// Each gains 41 nats (8192 values, amplitude 0.1): the powers of eight stretches alone would not
// do.
TEST(AdequacyWithASmallSweep, FailsInSlowAndFastOnes) {
  for (const double cycles : {80.0, 300.0, 900.0}) {
    std::vector<double> values = white(2);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double share = static_cast<double>(k) / kSamples;
      values[k] += 0.1414 * std::cos(2.0 * std::numbers::pi * cycles * (1.0 + share) * share);
    }
    EXPECT_THAT(adequacy_of(values).failures, Contains(HasSubstr("tone moves"))) << cycles;
  }
}

TEST(AdequacyWithPeriodicStrength, FailsAndSaysSo) {
  std::vector<double> values = white(3);
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] *= 1.0 + 0.3 * std::sin(static_cast<double>(k));
  }
  EXPECT_THAT(adequacy_of(values).failures, Contains(HasSubstr("has a period")));
}

TEST(AdequacyWithAFavouriteValue, FailsAndSaysSo) {
  std::vector<double> values = white(4);
  for (double& value : values) value = std::abs(value) < 0.05 ? 0.0 : value;
  EXPECT_THAT(adequacy_of(values).failures, Contains(HasSubstr("far more often")));
}

TEST(AdequacyWithADeadBand, FailsAndSaysSo) {
  std::vector<double> values = white(6);
  for (double& value : values) value = std::abs(value) < 0.5 ? 0.0 : value;
  EXPECT_THAT(adequacy_of(values).failures, Contains(HasSubstr("occurs far more often")));
}

TEST(AdequacyOfALattice, FailsOnlyWithAFavouriteLevel) {
  std::vector<double> values = white(7);
  for (double& value : values) value = 0.25 * std::round(4.0 * value);
  EXPECT_TRUE(adequacy_of(values).holds);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k % 3 == 0 && values[k] == 0.5) values[k] = 0.25;
  }
  EXPECT_THAT(adequacy_of(values).failures, Contains(HasSubstr("than its neighbours let expect")));
}

/// White noise on steps of 1/32, whose code 5 has taken in some of the codes above it, as a
/// converter of unequal steps does.
std::vector<double> with_a_wide_code(int wider) {
  std::vector<double> values = white(8);
  for (double& value : values) {
    const double code = std::round(32.0 * value);
    value = (code > 5.0 && code <= 5.0 + wider ? 5.0 : code) / 32.0;
  }
  return values;
}
TEST(AdequacyOfALatticeOfFineSteps, HoldsWithACodeTwiceAsWide) {
  EXPECT_TRUE(adequacy_of(with_a_wide_code(1)).holds);
  EXPECT_THAT(adequacy_of(with_a_wide_code(4)).failures,
              Contains(HasSubstr("than its neighbours let expect")));
}

TEST(AdequacyOfACoarserLattice, FailsWithoutEveryFourthLevel) {
  std::vector<double> values = white(9);
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = 0.6 * std::round((values[k] + (k < kSamples / 2 ? 0.0 : 3.0)) / 0.6);
  }
  EXPECT_THAT(adequacy_of(values).failures,
              Not(Contains(HasSubstr("than its neighbours let expect"))));
  for (double& value : values) {
    if (std::lround(value / 0.6) % 4 == 1) value -= 0.6;
  }
  EXPECT_THAT(adequacy_of(values).failures, Contains(HasSubstr("than its neighbours let expect")));
}

TEST(AdequacyWithANamedToneThatIsASquare, FailsByItsHarmonics) {
  constexpr double kCycles = 0.0137;
  std::vector<double> values = white(8);
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] +=
        std::sin(2.0 * std::numbers::pi * kCycles * static_cast<double>(k)) > 0.0 ? 0.2 : -0.2;
  }
  const EvenSeries series = series_of(std::move(values));
  const FitData data(series, 1);
  auto [cosine, sine] = tone_columns(data, kCycles);
  const Part tone{.effect = "periodic_disturbance",
                  .columns = {std::move(cosine), std::move(sine)},
                  .shape = {kCycles / series.period_s}};
  EXPECT_THAT(examine_adequacy(Hypothesis(data, {tone})).failures,
              Contains(HasSubstr("has harmonics")));
}

/// Two swings and a half of 10 K.
std::vector<double> swinging_temperature() {
  std::vector<double> temperature(kSamples);
  for (std::size_t k = 0; k < kSamples; ++k) {
    temperature[k] =
        25.0 + 5.0 * std::sin(5.0 * std::numbers::pi * static_cast<double>(k) / kSamples);
  }
  return temperature;
}

/// Adequacy of a record with its temperature and a random walk, both fitted.
Adequacy adequacy_with_temperature_and_walk(std::vector<double> values) {
  EvenSeries series = series_of(std::move(values));
  series.temperature_degc = swinging_temperature();
  const FitData data(series, 1);
  const Part drift{.effect = "temperature_drift",
                   .columns = {column_of(data, std::span(series.temperature_degc))}};
  const Hypothesis without(data, {drift});
  const std::optional<Candidate> walk = make_rate_random_walk()->examine(without);
  return examine_adequacy(Hypothesis(data, {drift, walk->part}, &without));
}

TEST(AdequacyOfAWalkInPlaceOfHysteresis, FailsAndSaysSo) {
  const std::vector<double> temperature = swinging_temperature();
  std::vector<double> values = white(10);
  double follower = temperature.front();
  for (std::size_t k = 0; k < kSamples; ++k) {
    follower = std::clamp(follower, temperature[k] - 2.0, temperature[k] + 2.0);
    values[k] += 0.15 * follower;
  }
  EXPECT_THAT(adequacy_with_temperature_and_walk(values).failures,
              Contains(HasSubstr("hysteresis in temperature")));
}

TEST(AdequacyOfATrueWalkBesideTemperature, DoesNotFailByHysteresis) {
  const std::vector<double> temperature = swinging_temperature();
  constexpr std::uint64_t kRuns = 20;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    std::vector<double> values = white(100 + run);
    const std::vector<double> steps = white(200 + run);
    double walk = 0.0;
    for (std::size_t k = 0; k < kSamples; ++k) {
      walk += 0.01 * steps[k];
      values[k] += walk + 0.1 * temperature[k];
    }
    // Two looks of some twenty that share an error of 1 %, twenty times: 2 % by chance.
    EXPECT_THAT(adequacy_with_temperature_and_walk(values).failures,
                Not(Contains(HasSubstr("hysteresis in temperature"))));
  }
}

TEST(Tails, AgreeWithTables) {
  EXPECT_NEAR(std::exp(statistics::log_normal_tails(1.959964)), 0.05, 1e-6);
  EXPECT_NEAR(std::exp(statistics::log_chi_squared_tail(18.307, 10.0)), 0.05, 1e-5);
  EXPECT_NEAR(std::exp(statistics::log_poisson_tail(3.0, 1.0)), 1.0 - 2.5 * std::exp(-1.0), 1e-9);
}

}  // namespace
}  // namespace zerorate::diagnose

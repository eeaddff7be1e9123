#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"
#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kPeriod_s = 0.1;

/// White noise of variance 1 with a warm-up and a ramp in it.
EvenSeries warmed_up(double time_constant_s) {
  EvenSeries series{.period_s = kPeriod_s, .rate_rad_s = std::vector<double>(4096)};
  random::RandomStream(31).fill_normal(0, series.rate_rad_s);
  for (std::size_t k = 0; k < series.rate_rad_s.size(); ++k) {
    const double time_s = kPeriod_s * static_cast<double>(k);
    series.rate_rad_s[k] += 3.0 * std::exp(-time_s / time_constant_s) + 2e-3 * time_s;
  }
  series.lost.resize(series.rate_rad_s.size());
  return series;
}

double ramp(double time_s) {
  return time_s;
}

/// Log likelihood at white noise of variance 1, so that nothing but amplitudes is fitted.
double log_likelihood(const FitData& data, const std::vector<Column>& columns) {
  const Hypothesis hypothesis(data, {Part{.columns = columns}}, std::vector(data.size(), 1.0));
  return hypothesis.log_likelihood();
}

// The slower the warm-up, the more it is a ramp: at 10^6 record lengths no digit tells them apart.
class WarmUpBesideARamp : public ::testing::TestWithParam<double> {};

TEST_P(WarmUpBesideARamp, GainsInTheFitWhatTheSearchForetold) {
  const EvenSeries series = warmed_up(50.0);
  const FitData data(series, 1);
  const std::vector<Column> fitted{column_of(data, ramp),
                                   decay_column(data, GetParam() * data.span_s())};
  const Column further = decay_column(data, 50.0);
  const Hypothesis hypothesis(data, {Part{.columns = fitted}}, std::vector(data.size(), 1.0));
  const double foretold = ColumnSearch(hypothesis).gain(further);
  const double gained =
      log_likelihood(data, {fitted[0], fitted[1], further}) - hypothesis.log_likelihood();
  EXPECT_GT(gained, 1.0);
  EXPECT_NEAR(foretold, gained, 1e-6 * gained);
}

INSTANTIATE_TEST_SUITE_P(OfRecordLengths, WarmUpBesideARamp,
                         ::testing::Values(0.2, 10.0, 1e3, 1e4, 1e5, 1e6));

// Every choice is compared with the fits of all candidates.
TEST(ColumnPursuit, ChoosesTheColumnThatGainsMostInTheFit) {
  const EvenSeries series = warmed_up(50.0);
  const FitData data(series, 1);
  std::vector<Column> chosen{column_of(data, ramp)};
  std::vector<Column> candidates;
  for (const double tau_s : {5.0, 20.0, 50.0, 80.0})
    candidates.push_back(decay_column(data, tau_s));
  candidates.push_back(step_column(data, 300));
  candidates.push_back(chosen.front());
  const Hypothesis hypothesis(data, {Part{.columns = chosen}}, std::vector(data.size(), 1.0));
  const ColumnSearch search(hypothesis);
  ColumnPursuit pursuit(search, candidates);
  std::vector<bool> is_left(candidates.size(), true);
  for (std::size_t count = 0; count + 1 < candidates.size(); ++count) {
    const double before = log_likelihood(data, chosen);
    std::size_t best = 0;
    double most = 0.0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (!is_left[i]) continue;
      std::vector<Column> columns = chosen;
      columns.push_back(candidates[i]);
      const double gain = log_likelihood(data, columns) - before;
      if (gain > most) best = i;
      most = std::max(most, gain);
    }
    const ColumnPursuit::Best found = pursuit.best();
    EXPECT_EQ(found.candidate, best) << count;
    EXPECT_NEAR(found.gain, most, 1e-6 * (1.0 + most)) << count;
    pursuit.choose(found.candidate);
    is_left[found.candidate] = false;
    chosen.push_back(candidates[found.candidate]);
  }
  EXPECT_EQ(pursuit.best().gain, 0.0) << "the ramp is there already";
}

TEST(CollinearColumn, GainsNothingAndHasALargeErrorButNoAmplitude) {
  const EvenSeries series = warmed_up(50.0);
  const FitData data(series, 1);
  const Column once = column_of(data, ramp);
  const Column twice = column_of(data, [](double time_s) { return 2.0 * time_s; });
  const Hypothesis hypothesis(data, {Part{.columns = {once, twice}}},
                              std::vector(data.size(), 1.0));
  EXPECT_EQ(hypothesis.amplitudes()[1], 0.0);
  EXPECT_GT(hypothesis.amplitude_variances()[1], 1e6 * hypothesis.amplitude_variances()[0]);
  EXPECT_EQ(ColumnSearch(hypothesis).gain(twice), 0.0);
  EXPECT_DOUBLE_EQ(hypothesis.log_likelihood(), log_likelihood(data, {once}));
}

TEST(NormalEquations, SolveASystemByHand) {
  NormalEquations equations;
  equations.add({}, 4.0);
  equations.add(std::vector{2.0}, 5.0);
  // (4 2; 2 5) x = (8, 12) has x = (1, 2); the inverse is (5 -2; -2 4) / 16.
  const std::vector<double> x = equations.amplitudes(std::vector{8.0, 12.0});
  EXPECT_DOUBLE_EQ(x[0], 1.0);
  EXPECT_DOUBLE_EQ(x[1], 2.0);
  const std::vector<double> variances = equations.variances();
  EXPECT_DOUBLE_EQ(variances[0], 5.0 / 16.0);
  EXPECT_DOUBLE_EQ(variances[1], 0.25);
}

EvenSeries noise_of(std::size_t size) {
  EvenSeries series{.period_s = 0.1, .rate_rad_s = std::vector<double>(size)};
  random::RandomStream(5).fill_normal(0, series.rate_rad_s);
  series.lost.resize(size);
  return series;
}

/// The greatest distance from the transform of the function itself, over its norm.
double error_of(const FitData& data, const Column& column,
                const std::function<double(double)>& function) {
  const Column exact = fast_column_of(data, function);
  double most = 0.0;
  double squares = 0.0;
  for (std::size_t k = column.first; k < column.end(); ++k) {
    const double value = exact.coefficients[k - 1];
    most = std::max(most, std::abs(column.coefficients[k - column.first] - value));
    squares += value * value;
  }
  return most / std::sqrt(squares);
}

class ColumnsOfARecord : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ColumnsOfARecord, AreTheTransformsOfTheirFunctions) {
  const EvenSeries series = noise_of(GetParam());
  const FitData data(series, 1);
  const double span_s = data.span_s();
  const double tau_s = 0.03 * span_s;
  EXPECT_LT(
      error_of(data, decay_column(data, tau_s), [=](double t) { return std::exp(-t / tau_s); }),
      1e-10);
  const std::size_t jump = data.size() / 3;
  for (const double decay_s : {tau_s, 0.25}) {
    EXPECT_LT(error_of(data, fast_decay_column(data, decay_s, jump),
                       [=](double t) {
                         const double since_s = t - static_cast<double>(jump) * 0.1;
                         return since_s < -0.05 ? 0.0 : std::exp(-since_s / decay_s);
                       }),
              1e-10);
  }
  EXPECT_LT(
      error_of(data, step_column(data, jump),
               [=](double t) { return t < (static_cast<double>(jump) - 0.5) * 0.1 ? 0.0 : 1.0; }),
      1e-10);
  for (const double cycles : {0.01237, 0.25, 0.4871}) {
    const double rad_per_s = 2.0 * std::numbers::pi * cycles / 0.1;
    const auto [cosine, sine] = tone_columns(data, cycles);
    EXPECT_LT(error_of(data, cosine, [=](double t) { return std::cos(rad_per_s * t); }), 1e-3);
    EXPECT_LT(error_of(data, sine, [=](double t) { return std::sin(rad_per_s * t); }), 1e-3);
  }
  EXPECT_LT(error_of(data, column_of(data, [](double t) { return t; }), [](double t) { return t; }),
            1e-4);
}

INSTANTIATE_TEST_SUITE_P(ShortAndLong, ColumnsOfARecord, ::testing::Values(2000U, 200'000U),
                         ::testing::PrintToStringParamName());

TEST(ColumnOfValuesOfALongRecord, IsThatOfTheirFunction) {
  const EvenSeries series = noise_of(200'000);
  const FitData data(series, 1);
  ASSERT_GT(data.block(), 1U);
  const auto wave = [&](double t) { return std::sin(20.0 * t / data.span_s()); };
  std::vector<double> values;
  for (std::size_t k = 0; k < data.size(); ++k) values.push_back(wave(data.time_s(k)));
  EXPECT_LT(error_of(data, column_of(data, std::span<const double>(values)), wave), 1e-5);
}

TEST(ColumnOfTheMeansOfARecord, IsThatOfItsValues) {
  constexpr std::size_t kCount = 20;
  EvenSeries series{.period_s = kPeriod_s, .rate_rad_s = std::vector<double>(100'000)};
  series.lost.resize(series.size());
  const EvenSeries of_means = means_of(series, kCount);
  const FitData values(series, 1);
  const FitData means(of_means, 1);
  constexpr double kTau_s = 400.0;
  const Column exact = decay_column(values, kTau_s);
  const Column column = column_of_values(values, means, decay_column(means, kTau_s));
  // A mean of 2 s is 0.005 time constants; the constant of the function is nobody's.
  for (std::size_t k = 1; k < 100; ++k) {
    EXPECT_NEAR(column.coefficients[k - 1], exact.coefficients[k - 1],
                0.01 * std::abs(exact.coefficients[k - 1]))
        << k;
  }
}

}  // namespace
}  // namespace zerorate::diagnose

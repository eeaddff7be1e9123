// Intervals by drawing again, and the significance of a search.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::statistics {
namespace {

using random::RandomStream;

double mean_of(const std::vector<double>& values, const std::vector<std::size_t>& indices) {
  double sum = 0.0;
  for (const std::size_t i : indices) sum += values[i];
  return sum / static_cast<double>(indices.size());
}

/// Share of data sets whose interval of the mean holds the true one, 0. Each of the 100 values is
/// the sum of `kept` times the one before it and a normal deviate.
double coverage_of_the_mean(double kept, std::size_t block) {
  constexpr std::uint64_t kSets = 400;
  double covered = 0.0;
  for (std::uint64_t set = 0; set < kSets; ++set) {
    std::vector<double> values(100);
    RandomStream(1).substream(set).fill_normal(0, values);
    for (std::size_t k = 1; k < values.size(); ++k) values[k] += kept * values[k - 1];
    const auto figure =
        bootstrap(values.size(), [&](const auto& drawn) { return mean_of(values, drawn); },
                  RandomStream(2).substream(set), {.draws = 200, .block = block});
    if (figure.lo <= 0.0 && figure.hi >= 0.0) covered += 1.0;
  }
  return covered / static_cast<double>(kSets);
}

TEST(BootstrapOfAMean, CoversTheTruthAsOftenAsItSays) {
  // Three standard deviations of 400 sets; intervals of 200 draws are a little short.
  EXPECT_NEAR(coverage_of_the_mean(0.0, 1), 0.945, 3.0 * std::sqrt(0.05 * 0.95 / 400.0));
}

TEST(BootstrapOfDependentNeighbours, NeedsBlocks) {
  // An autoregression of 0.5 has a mean of three times the variance that independence would give.
  EXPECT_LT(coverage_of_the_mean(0.5, 1), 0.80);
  EXPECT_GT(coverage_of_the_mean(0.5, 8), 0.85);
}

TEST(BootstrapWithoutAValue, SaysNothing) {
  const auto figure = bootstrap(
      3, [](const auto&) { return std::nan(""); }, RandomStream(1));
  EXPECT_TRUE(std::isnan(figure.value) && std::isnan(figure.lo) && std::isnan(figure.hi));
}

TEST(EvenLengths, AreAsRareByChanceAsStated) {
  constexpr std::uint64_t kDraws = 4000;
  const double log_tenth = std::log(0.1);
  std::size_t rare = 0;
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    const RandomStream stream = RandomStream(3).substream(draw);
    std::array<std::vector<double>, 2> lengths;
    for (std::int64_t k = 0; k < 9; ++k) {
      lengths[static_cast<std::size_t>(k % 2)].push_back((k % 2 == 0 ? -2.0 : -7.0) *
                                                         std::log(stream.uniform(k)));
    }
    if (log_p_of_even_lengths(lengths) < log_tenth) ++rare;
  }
  // Bartlett's correction leaves 0.4 % of error; three standard errors are 1.4 %.
  EXPECT_NEAR(static_cast<double>(rare) / kDraws, 0.1, 0.018);
}

TEST(EvenLengths, ArePlainWhereAllAreAlike) {
  const std::array<std::vector<double>, 2> alike{{{1.0, 1.01, 0.99, 1.0}, {3.0}}};
  EXPECT_LT(log_p_of_even_lengths(alike), std::log(1e-5));
  const std::array<std::vector<double>, 2> single{{{1.0}, {3.0}}};
  EXPECT_EQ(log_p_of_even_lengths(single), 0.0);
}

TEST(RankSumTail, CountsTheOrdersOfTwoGroups) {
  // Orders of four and four with 0, 1, 2, 3 and 4 pairs: 1, 1, 2, 3 and 5 of 70.
  const std::vector<double> tail = rank_sum_tail(4, 4);
  ASSERT_EQ(tail.size(), 9U);
  const std::array orders{1.0, 2.0, 4.0, 7.0, 12.0};
  for (std::size_t u = 0; u < orders.size(); ++u) EXPECT_NEAR(tail[u], orders[u] / 70.0, 1e-15);
}

TEST(RankSumTail, IsThatOfOneInAllOrdersAtItsEndAndHalfInTheMiddle) {
  // Forty of a thousand, whose orders are 1e72 in number.
  const std::vector<double> tail = rank_sum_tail(40, 960);
  const double orders = std::lgamma(1001.0) - std::lgamma(41.0) - std::lgamma(961.0);
  EXPECT_NEAR(std::log(tail.front()), -orders, 1e-9);
  EXPECT_NEAR(tail.back(), 0.5, 1e-3);  // and half of the order in the middle
}

TEST(SurpriseOfNoGain, IsNothing) {
  EXPECT_EQ(surprisal_of_free(0.0, 1.0), 0.0);
  EXPECT_EQ(surprisal_of_strength(0.0), 0.0);
  EXPECT_NEAR(surprisal_of_search(0.0, 1.0, 10.0), 0.0, 1e-12);
}

TEST(Surprise, IsTheLogarithmOfChiSquaredTails) {
  // 3.841 and 5.991: 95 % points of one and two degrees of freedom, from tables.
  EXPECT_NEAR(surprisal_of_free(0.5 * 3.841, 1.0), -std::log(0.05), 1e-3);
  EXPECT_NEAR(surprisal_of_free(0.5 * 5.991, 2.0), -std::log(0.05), 1e-3);
  EXPECT_NEAR(surprisal_of_strength(0.5 * 3.841), -std::log(0.025), 1e-3);
}

TEST(Surprise, IsContinuousWhereProbabilitiesUnderflow) {
  EXPECT_NEAR(surprisal_of_free(300.1, 1.0) - surprisal_of_free(299.9, 1.0), 0.2, 2e-3);
}

TEST(SurpriseOfASearch, PaysForTheLevelCrossings) {
  const double free = surprisal_of_search(30.0, 2.0, 0.0);
  EXPECT_NEAR(free - surprisal_of_search(30.0, 2.0, 99.0), std::log(100.0), 1e-9);
}

/// Mean of a normal value after rounding: the sum over the whole numbers, by their probabilities.
double mean_after_rounding(double mean, double sigma) {
  double sum = 0.0;
  for (int n = -20; n <= 20; ++n) {
    const double unit = sigma * std::numbers::sqrt2;
    sum += 0.5 * n * (std::erf((n + 0.5 - mean) / unit) - std::erf((n - 0.5 - mean) / unit));
  }
  return sum;
}

TEST(MeanBeforeRounding, IsTheMeanThatRoundingMakesTheOther) {
  for (const double sigma : {0.15, 0.25, 0.4, 0.59, 1.0}) {
    const MeanBeforeRounding before(sigma);
    for (double mean = -1.7; mean < 1.7; mean += 0.0371) {
      const double after = mean_after_rounding(mean, sigma);
      EXPECT_NEAR(before(after), mean, 2e-3) << sigma;
    }
  }
}

// Values that hardly vary are rounded to steps: a mean between two of them comes from near the
// edge.
TEST(MeanBeforeRounding, OfAlmostEqualValuesIsNearTheEdge) {
  for (const double sigma : {1e-6, 1e-3, 0.02, 0.05}) {
    const MeanBeforeRounding before(sigma);
    for (double mean = -0.9; mean < 1.0; mean += 0.1) {
      EXPECT_LE(std::abs(before(mean) - mean), 0.5) << sigma << ' ' << mean;
      if (sigma < 0.02 || std::abs(mean - std::round(mean)) < 0.05) continue;
      EXPECT_NEAR(before(mean), std::floor(mean) + 0.5, 4.0 * sigma) << sigma << ' ' << mean;
    }
  }
}

}  // namespace
}  // namespace zerorate::statistics

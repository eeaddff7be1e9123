#include "host_tools/lib/statistics/bootstrap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

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

}  // namespace
}  // namespace zerorate::statistics

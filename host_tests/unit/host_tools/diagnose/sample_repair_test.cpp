#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

constexpr std::size_t kSize = 20'000;

std::vector<double> white_noise() {
  std::vector<double> values(kSize);
  random::RandomStream(3).fill_normal(0, values);
  return values;
}

TEST(RepairOfNothing, ChangesNothing) {
  const std::vector<double> values = white_noise();
  EXPECT_EQ(repair(values, std::vector<bool>(kSize), {}, 1), values);
}

TEST(RepairedValues, HaveTheLevelAndTheSpreadOfTheirNeighbours) {
  constexpr double kLevel = 10.0;
  std::vector<double> values = white_noise();
  std::vector<bool> is_replaced(kSize);
  for (std::size_t k = 0; k < kSize; ++k) {
    values[k] += kLevel;
    is_replaced[k] = k % 20 < 4;
    if (is_replaced[k]) values[k] = 1e6;
  }
  const std::vector<double> repaired = repair(values, is_replaced, {}, 1);
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < kSize; ++k) {
    if (!is_replaced[k]) {
      EXPECT_EQ(repaired[k], values[k]);
      continue;
    }
    sum += repaired[k] - kLevel;
    squares += (repaired[k] - kLevel) * (repaired[k] - kLevel);
    count += 1.0;
  }
  // 1,000 bridges between means of eight values, with noise of variance 1: a bridge has a variance
  // of 1/8 to 1/16, and the values of one share it.
  EXPECT_NEAR(sum / count, 0.0, 5.0 * std::sqrt(1.0 / count + 0.125 / 1000.0));
  EXPECT_NEAR(squares / count, 1.1, 5.0 * 1.1 * std::sqrt(2.0 / count) + 0.05);
}

TEST(RepairedValuesAtAnEndOfTheRange, LieBeyondIt) {
  std::vector<double> values = white_noise();
  std::vector<bool> is_replaced(kSize);
  for (std::size_t k = 0; k < kSize; ++k) {
    if (values[k] < 1.0) continue;
    values[k] = 1.0;
    is_replaced[k] = true;
  }
  const std::vector<double> repaired = repair(values, is_replaced, {.hi = 1.0}, 1);
  for (std::size_t k = 0; k < kSize; ++k) {
    if (is_replaced[k]) {
      EXPECT_GE(repaired[k], 1.0) << k;
    }
  }
}

}  // namespace
}  // namespace zerorate::diagnose

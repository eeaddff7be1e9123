#include "core/estimator/suffix_sums.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace zerorate::core {
namespace {

/// Noise with a slow part, so that a block's two parts differ.
std::vector<float> wandering_rates(std::size_t n) {
  std::mt19937 random(42);
  std::normal_distribution<float> normal;
  std::vector<float> rates(n);
  float slow = 0.0F;
  for (float& rate : rates) {
    slow += 0.05F * normal(random);
    rate = slow + normal(random);
  }
  return rates;
}

TEST(SuffixSums, AreExactForTheNewestMeasurements) {
  const auto rates = wandering_rates(100'000);
  SuffixSums<> sums;
  for (const float rate : rates) sums.push(rate);
  float exact = 0.0F;
  for (std::uint32_t length = 1; length < SuffixSums<>::kExact; ++length) {
    exact += rates[rates.size() - length];
    EXPECT_EQ(sums.sum_of_newest(length), exact);
  }
}

TEST(SuffixSums, StayWithinTheStatedDeviationOfTheExactMean) {
  const auto rates = wandering_rates(300'000);
  const double fraction = 1.0 / (4.0 * (SuffixSums<>::kPerLevel - 1));
  SuffixSums<> sums;
  std::vector<double> prefix{0.0};
  for (const float rate : rates) {
    sums.push(rate);
    prefix.push_back(prefix.back() + double{rate});
  }
  const auto mean_between = [&](std::size_t from, std::size_t to) {
    return (prefix[to] - prefix[from]) / static_cast<double>(to - from);
  };
  std::size_t newer = 0;
  sums.for_each_newest_first([&](std::uint32_t size, float) {
    const std::size_t newest = rates.size() - newer;
    for (std::size_t part = 1; part < size; part += std::max<std::size_t>(1, size / 7)) {
      const auto length = static_cast<std::uint32_t>(newer + part);
      const double exact = mean_between(rates.size() - length, rates.size());
      const double halves = std::abs(mean_between(newest - part, newest) -
                                     mean_between(newest - size, newest - part));
      const double deviation = std::abs(double{sums.sum_of_newest(length)} / length - exact);
      EXPECT_LE(deviation, fraction * halves + 1e-4) << "suffix of " << length;
    }
    newer += size;
    return true;
  });
  EXPECT_EQ(newer, rates.size());
}

TEST(SuffixSumsOfAHundredMillion, CountEveryMeasurement) {
  SuffixSums<> sums;
  constexpr std::uint32_t kMany = 110'000'000;  // more than the rings hold: the oldest swallows
  for (std::uint32_t k = 0; k < kMany; ++k) sums.push(1.0F);
  EXPECT_EQ(sums.count(), kMany);
  EXPECT_FLOAT_EQ(sums.sum_of_newest(kMany), 1.1e8F);
  EXPECT_FLOAT_EQ(sums.sum_of_newest(kMany / 3), static_cast<float>(kMany / 3));
}

}  // namespace
}  // namespace zerorate::core

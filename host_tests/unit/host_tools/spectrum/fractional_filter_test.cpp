#include "host_tools/lib/spectrum/fractional_filter.hpp"

#include <gtest/gtest.h>

#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

namespace zerorate::spectrum {
namespace {

// Any sequence defined for negative indices too.
double input_at(std::ptrdiff_t k) {
  const auto t = static_cast<double>(k);
  return std::sin(0.7 * t) + std::cos(0.013 * t * t);
}

void fill_input(std::ptrdiff_t first, std::span<double> block) {
  for (std::size_t i = 0; i < block.size(); ++i) {
    block[i] = input_at(first + static_cast<std::ptrdiff_t>(i));
  }
}

// psi_j = Gamma(j + d) / (Gamma(d) Gamma(j + 1)), not by the recursion; d > 0.
double weight(double order, std::ptrdiff_t j) {
  return boost::math::tgamma_delta_ratio(static_cast<double>(j) + order, 1.0 - order) /
         boost::math::tgamma(order);
}

double convolved_at(double order, std::ptrdiff_t k, std::ptrdiff_t history) {
  double sum = 0.0;
  for (std::ptrdiff_t j = 0; j <= k + history; ++j) sum += weight(order, j) * input_at(k - j);
  return sum;
}

TEST(FractionalWeights, AreTheSumAtOrderOneAndTheBinomialsAtOrderHalf) {
  FractionalWeights sum(1.0);
  for (int j = 0; j < 10; ++j) EXPECT_EQ(sum.next(), 1.0);
  FractionalWeights half(0.5);
  for (const double expected : {1.0, 1.0 / 2, 3.0 / 8, 5.0 / 16, 35.0 / 128, 63.0 / 256}) {
    EXPECT_DOUBLE_EQ(half.next(), expected);
  }
}

TEST(FractionalIntegration, EqualsTheDirectSumWithEveryStart) {
  for (const std::size_t history : {0U, 1U, 63U, 64U, 65U, 200U}) {
    for (const double order : {0.2, 0.5, 0.9}) {
      std::vector<double> output(50);
      integrate_fractionally(order, fill_input, history, output);
      for (std::size_t k = 0; k < output.size(); ++k) {
        const auto index = static_cast<std::ptrdiff_t>(k);
        EXPECT_NEAR(output[k], convolved_at(order, index, static_cast<std::ptrdiff_t>(history)),
                    1e-12)
            << history << ' ' << order << ' ' << k;
      }
    }
  }
}

TEST(FractionalIntegration, EqualsTheDirectSumAcrossPartitions) {
  constexpr std::size_t kSamples = 150'000;  // three partitions of 65536
  constexpr std::size_t kHistory = 100'000;
  std::vector<double> output(kSamples);
  integrate_fractionally(0.5, fill_input, kHistory, output);
  for (const std::size_t k : {0U, 1U, 65535U, 65536U, 131071U, 131072U, 149'999U}) {
    const auto index = static_cast<std::ptrdiff_t>(k);
    EXPECT_NEAR(output[k], convolved_at(0.5, index, kHistory), 1e-10) << k;
  }
}

TEST(FractionalDifference, OfOrderOneIsTheDifference) {
  std::vector<double> values(1000);
  fill_input(0, values);
  const std::vector<double> differences = difference_fractionally(1.0, values);
  EXPECT_NEAR(differences[0], values[0], 1e-13);
  for (std::size_t k = 1; k < values.size(); ++k) {
    EXPECT_NEAR(differences[k], values[k] - values[k - 1], 1e-13);
  }
}

TEST(FractionalDifference, IsUndoneByItsNegative) {
  std::vector<double> values(3001);
  fill_input(0, values);
  const std::vector<double> back =
      difference_fractionally(-0.7, difference_fractionally(0.7, values));
  for (std::size_t k = 0; k < values.size(); ++k) EXPECT_NEAR(back[k], values[k], 1e-11);
}

TEST(FractionalDifference, OfNothingIsNothing) {
  EXPECT_TRUE(difference_fractionally(0.5, {}).empty());
}

}  // namespace
}  // namespace zerorate::spectrum

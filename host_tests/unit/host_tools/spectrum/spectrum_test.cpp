#include "host_tools/lib/spectrum/fractional_filter.hpp"

#include <gtest/gtest.h>

#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/spectrum/transforms.hpp"

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

TEST(FractionalWeights, AreASumAtOrder1AndBinomialsAtHalf) {
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

std::vector<double> chirp(std::size_t n) {
  std::vector<double> values(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto t = static_cast<double>(k);
    values[k] = std::cos(0.3 * t + 0.01 * t * t) + 0.1 * t;
  }
  return values;
}

TEST(RealFft, EqualsTheDefinition) {
  for (const std::size_t n : {2U, 4U, 6U, 30U, 64U, 250U, 14U}) {
    const std::vector<double> values = chirp(n);
    const RealFft fft(n);
    std::vector<std::complex<double>> bins(fft.bins());
    fft.forward(values, bins);
    for (std::size_t j = 0; j < bins.size(); ++j) {
      std::complex<double> sum = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        const double turn = static_cast<double>(j * k % n) / static_cast<double>(n);
        sum += values[k] * std::polar(1.0, -2.0 * std::numbers::pi * turn);
      }
      EXPECT_NEAR(std::abs(bins[j] - sum), 0.0, 1e-13 * static_cast<double>(n * n))
          << n << ' ' << j;
    }
  }
}

TEST(ComplexFft, EqualsTheDefinition) {
  for (const std::size_t n : {1U, 2U, 30U, 64U, 125U, 14U}) {
    const std::vector<double> real = chirp(n);
    std::vector<std::complex<double>> values(n);
    for (std::size_t k = 0; k < n; ++k) values[k] = {real[k], real[n - 1 - k]};
    std::vector<std::complex<double>> bins(n);
    ComplexFft(n).forward(values, bins);
    for (std::size_t j = 0; j < n; ++j) {
      std::complex<double> sum = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        const double turn = static_cast<double>(j * k % n) / static_cast<double>(n);
        sum += values[k] * std::polar(1.0, -2.0 * std::numbers::pi * turn);
      }
      EXPECT_NEAR(std::abs(bins[j] - sum), 0.0, 1e-13 * static_cast<double>(n * n + 1))
          << n << ' ' << j;
    }
  }
}

TEST(RealFft, InverseUndoesForward) {
  for (const std::size_t n : {2U, 6U, 1000U, 4096U}) {
    const std::vector<double> values = chirp(n);
    const RealFft fft(n);
    std::vector<std::complex<double>> bins(fft.bins());
    std::vector<double> back(n);
    fft.forward(values, bins);
    fft.inverse(bins, back);
    for (std::size_t k = 0; k < n; ++k)
      EXPECT_NEAR(back[k], values[k], 1e-15 * static_cast<double>(n));
  }
}

TEST(RealFftDeathTest, StopsAtOddLengthsAndWrongSizes) {
  EXPECT_DEATH(RealFft(0), "");
  EXPECT_DEATH(RealFft(7), "");
  const RealFft fft(8);
  std::vector<double> values(8);
  std::vector<std::complex<double>> bins(4);
  EXPECT_DEATH(fft.forward(values, bins), "");
  EXPECT_DEATH(fft.inverse(bins, values), "");
}

TEST(FastLength, IsEvenAndHasNoFactorAboveFive) {
  EXPECT_EQ(fast_length_below(2), 2U);
  EXPECT_EQ(fast_length_below(7), 6U);
  EXPECT_EQ(fast_length_below(2003), 2000U);
  EXPECT_EQ(fast_length_below(1'000'003), 1'000'000U);
  for (std::size_t n = 1000; n < 100'000; n += 997) {
    const std::size_t length = fast_length_below(n);
    EXPECT_LE(length, n);
    EXPECT_GT(static_cast<double>(length), 0.94 * static_cast<double>(n));
  }
}

TEST(CosineTransform, EqualsTheDefinitionAndKeepsThePower) {
  for (const std::size_t n : {2U, 4U, 6U, 60U, 128U}) {
    std::vector<double> values(n);
    for (std::size_t i = 0; i < n; ++i) values[i] = std::sin(static_cast<double>(i * i) + 0.3);
    const std::vector<double> coefficients = cosine_transform(values);
    double power = 0.0;
    double transformed_power = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      double sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        const double turn = static_cast<double>(k * (2 * i + 1)) / static_cast<double>(2 * n);
        sum += values[i] * std::cos(std::numbers::pi * turn);
      }
      const double norm = std::sqrt((k == 0 ? 1.0 : 2.0) / static_cast<double>(n));
      EXPECT_NEAR(coefficients[k], norm * sum, 1e-13 * static_cast<double>(n)) << n << ' ' << k;
      power += values[k] * values[k];
      transformed_power += coefficients[k] * coefficients[k];
    }
    EXPECT_NEAR(transformed_power, power, 1e-13 * power);
  }
}

TEST(CosineTransform, InverseUndoesForward) {
  for (const std::size_t n : {2U, 6U, 60U, 128U}) {
    const CosineTransform transform(n);
    std::vector<double> values(n);
    for (std::size_t i = 0; i < n; ++i) values[i] = std::cos(static_cast<double>(i * i) + 0.7);
    const std::vector<double> back = transform.inverse(transform.forward(values));
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(back[i], values[i], 1e-14) << n << ' ' << i;
  }
}

}  // namespace
}  // namespace zerorate::spectrum

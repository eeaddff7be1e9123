#include "host_tools/lib/spectrum/cosine_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace zerorate::spectrum {
namespace {

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

#include "host_tools/lib/reference/autoregression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::reference {
namespace {

// y = 5 + 1.2 (y_1 - 5) - 0.5 (y_2 - 5) + 2 e: a damped oscillation.
std::vector<double> second_order(std::size_t n) {
  std::vector<double> noise(n);
  random::RandomStream{11}.fill_normal(0, noise);
  std::vector<double> y(n, 5.0);
  for (std::size_t k = 2; k < n; ++k) {
    y[k] = 5.0 + 1.2 * (y[k - 1] - 5.0) - 0.5 * (y[k - 2] - 5.0) + 2.0 * noise[k];
  }
  return y;
}

TEST(Autoregression, IsRecoveredByBothFits) {
  const std::size_t n = 20'000;
  const std::vector<double> y = second_order(n);
  // Standard error of each coefficient: sqrt((1 - 0.5^2) / n) (Box and Jenkins, section 7.2).
  const double tolerance = 4.0 * std::sqrt(0.75 / static_cast<double>(n));
  for (const Autoregression& fit : {fit_least_squares(y, 2), fit_burg(y, 2)}) {
    EXPECT_NEAR(fit.coefficients(0), 1.2, tolerance);
    EXPECT_NEAR(fit.coefficients(1), -0.5, tolerance);
    // Standard error of the variance: sqrt(2 / n) of it.
    EXPECT_NEAR(fit.innovation_variance, 4.0, 4.0 * 4.0 * std::sqrt(2.0 / static_cast<double>(n)));
    // The mean's: 2 / (1 - 1.2 + 0.5) / sqrt(n).
    EXPECT_NEAR(fit.mean, 5.0, 4.0 * 2.0 / 0.3 / std::sqrt(static_cast<double>(n)));
  }
}

TEST(Autoregression, FitsAgreeOnALongRecord) {
  const std::vector<double> y = second_order(20'000);
  const Autoregression one = fit_least_squares(y, 6);
  const Autoregression other = fit_burg(y, 6);
  // They differ by their treatment of the ends: by O(order / n).
  EXPECT_LT((one.coefficients - other.coefficients).cwiseAbs().maxCoeff(), 20.0 / 20'000);
}

TEST(AutoregressionForecast, IsTheIteratedRecursionAndItsImpulseResponse) {
  const Autoregression model{
      .mean = 5.0, .coefficients = Eigen::Vector2d{1.2, -0.5}, .innovation_variance = 4.0};
  const std::vector<double> y{0.0, 7.0, 8.0};
  const Forecast ahead = forecast(model, y, 3);
  const double first = 5.0 + 1.2 * 3.0 - 0.5 * 2.0;
  const double second = 5.0 + 1.2 * (first - 5.0) - 0.5 * 3.0;
  EXPECT_DOUBLE_EQ(ahead.values(0), first);
  EXPECT_DOUBLE_EQ(ahead.values(1), second);
  EXPECT_DOUBLE_EQ(ahead.values(2), 5.0 + 1.2 * (second - 5.0) - 0.5 * (first - 5.0));
  const double psi2 = 1.2 * 1.2 - 0.5;
  EXPECT_DOUBLE_EQ(ahead.variance(2), 4.0 * (1.0 + 1.44 + psi2 * psi2));
}

TEST(AutoregressionForecast, IsItsWeightsTimesTheNewestValues) {
  const std::vector<double> y = second_order(1000);
  const Autoregression model = fit_burg(y, 30);
  const Eigen::Map<const Eigen::VectorXd> newest{y.data() + 970, 30};
  const Eigen::VectorXd weighed =
      (forecast_weights(model, 200) * (newest.array() - model.mean).matrix()).array() + model.mean;
  EXPECT_LT((weighed - forecast(model, y, 200).values).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(AutoregressionForecast, OfBurgsModelReturnsToTheMean) {
  const std::vector<double> y = second_order(1000);
  const Autoregression model = fit_burg(y, 120);
  EXPECT_NEAR(forecast(model, y, 5000).values(4999), model.mean, 1e-6);
}

TEST(Autoregression, RefusesTooFewValues) {
  const std::vector<double> y(8);
  EXPECT_THROW((void)fit_least_squares(y, 4), std::invalid_argument);
  EXPECT_THROW((void)fit_burg(y, 8), std::invalid_argument);
}

}  // namespace
}  // namespace zerorate::reference

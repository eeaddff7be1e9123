// Covariances against sums over small steps of time, and the forecast of the bias against ones that
// were worked out by hand.

#include "host_tools/lib/diagnose/drive/bias_process.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace zerorate::diagnose {
namespace {

constexpr Span kStop{.from_s = 10.0, .to_s = 40.0};
constexpr Span kDrive{.from_s = 45.0, .to_s = 145.0};
constexpr Span kNextStop{.from_s = 150.0, .to_s = 180.0};

/// Sum over both spans of a covariance of two times, in steps of 0.5 s.
template <class Covariance>
double summed(const Span& one, const Span& other, const Covariance& covariance) {
  constexpr double kStep_s = 0.5;
  double sum = 0.0;
  for (double s = one.from_s + 0.5 * kStep_s; s < one.to_s; s += kStep_s) {
    for (double t = other.from_s + 0.5 * kStep_s; t < other.to_s; t += kStep_s)
      sum += covariance(s, t) * kStep_s * kStep_s;
  }
  return sum;
}

/// Covariance without the share of the unknown mean, which a model of no noise has alone.
double covariance_of(const model::SensorModel& model, const Span& one, const Span& other) {
  return BiasProcess{model}.covariance(one, other) - BiasProcess{{}}.covariance(one, other);
}

TEST(BiasProcess, LagsAreCorrelatedByTheirDistance) {
  model::SensorModel model;
  model.gauss_markov.push_back({.sigma_rad_s = 0.1, .time_constant_s = 60.0});
  const auto expected = [](double s, double t) { return 0.01 * std::exp(-std::abs(s - t) / 60.0); };
  for (const Span& other : {kStop, kDrive, kNextStop}) {
    const double wanted = summed(kStop, other, expected);
    EXPECT_NEAR(covariance_of(model, kStop, other), wanted, 1e-4 * wanted);
  }
}

TEST(BiasProcess, AWalkHasTheCovarianceOfTheEarlierTime) {
  model::SensorModel model;
  model.rate_random_walk = {.coefficient_rad_s_per_sqrt_s = 0.1};
  const auto expected = [](double s, double t) { return 0.01 * std::min(s, t); };
  for (const Span& other : {kStop, kDrive}) {
    const double wanted = summed(kStop, other, expected);
    EXPECT_NEAR(covariance_of(model, kStop, other), wanted, 1e-3 * wanted);
  }
}

TEST(BiasProcess, WhiteNoiseOfDifferentSpansIsIndependent) {
  model::SensorModel model;
  model.white.angle_random_walk_rad_per_sqrt_s = 0.2;
  EXPECT_NEAR(covariance_of(model, kStop, kStop), 0.04 * 30.0, 1e-9);
  EXPECT_NEAR(covariance_of(model, kStop, kDrive), 0.0, 1e-12);
}

// The best estimate of a constant in white noise is the mean of all that was measured.
TEST(ForecastOfTheBias, OfWhiteNoiseIsTheMeanAtRest) {
  model::SensorModel model;
  model.white.angle_random_walk_rad_per_sqrt_s = 1e-4;
  const BiasForecast forecast = forecast_bias(BiasProcess{model}, {kStop, kNextStop}, {kDrive});
  constexpr double kAtRest_s = 60.0;
  EXPECT_NEAR(forecast.weights(0, 0), 100.0 / kAtRest_s, 1e-3);
  EXPECT_NEAR(forecast.weights(0, 1), 100.0 / kAtRest_s, 1e-3);
  const double wanted = 1e-8 * (100.0 + 100.0 * 100.0 / kAtRest_s);
  EXPECT_NEAR(forecast.covariance(0, 0), wanted, 1e-3 * wanted);
}

// Two drives between the same stops err alike by the bias that was measured there.
TEST(ForecastOfTheBias, DrivesShareTheErrorsOfTheirStops) {
  model::SensorModel model;
  model.white.angle_random_walk_rad_per_sqrt_s = 1e-4;
  const Span drive{.from_s = 200.0, .to_s = 300.0};
  const BiasForecast forecast =
      forecast_bias(BiasProcess{model}, {kStop, kNextStop}, {kDrive, drive});
  const double wanted = 1e-8 * 100.0 * 100.0 / 60.0;
  EXPECT_NEAR(forecast.covariance(0, 1), wanted, 1e-3 * wanted);
}

// The middle of a walk between two stops is half of both.
TEST(ForecastOfTheBias, OfAWalkLiesBetweenTheNeighbours) {
  model::SensorModel model;
  model.white.angle_random_walk_rad_per_sqrt_s = 1e-6;
  model.rate_random_walk = {.coefficient_rad_s_per_sqrt_s = 1e-5};
  const BiasForecast forecast = forecast_bias(BiasProcess{model}, {kStop, kNextStop}, {kDrive});
  EXPECT_NEAR(forecast.weights(0, 0), 0.5 * 100.0 / 30.0, 1e-2);
  EXPECT_NEAR(forecast.weights(0, 1), 0.5 * 100.0 / 30.0, 1e-2);
}

}  // namespace
}  // namespace zerorate::diagnose

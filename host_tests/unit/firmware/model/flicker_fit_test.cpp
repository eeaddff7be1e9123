#include "firmware/model/flicker_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <stdexcept>

namespace zerorate::model {
namespace {

constexpr double kPi = std::numbers::pi;

Flicker flicker_of_order(double order) {
  return {.bias_instability_rad_s = 1e-4,
          .order = order,
          .decades = 6,
          .shortest_time_constant_s = 1.0};
}

/// Oracle: the spectrum per tick of the fitted sum, straight from its transfer functions.
double fitted_spectrum(const FlickerFit& fit, double tick_s, double f) {
  double sum = fit.white_variance_rad2_s2;
  for (std::size_t i = 0; i < fit.time_constants_s.size(); ++i) {
    const double phi = std::exp(-tick_s / fit.time_constants_s[i]);
    const double q = fit.variances_rad2_s2[i] * (1.0 - phi * phi);
    sum += q / std::norm(1.0 - phi * std::polar(1.0, -2.0 * kPi * f));
  }
  return sum;
}

double flicker_spectrum(const Flicker& flicker, double tick_s, double f) {
  const double b = flicker.bias_instability_rad_s;
  return b * b * std::pow(tick_s, 2.0 * flicker.order - 1.0) *
         std::pow(std::abs(1.0 - std::polar(1.0, -2.0 * kPi * f)), -2.0 * flicker.order);
}

struct Ripple {
  double least = 1e300;
  double greatest = 0.0;
};

/// On a grid of its own, from `octaves` above the slowest lag's corner to half the rate.
Ripple measured_ripple(const Flicker& flicker, double tick_s, double octaves) {
  const FlickerFit fit = fit_flicker(flicker, tick_s);
  const double corner = tick_s / (2.0 * kPi * fit.time_constants_s.back());
  Ripple ripple;
  for (double f = corner * std::exp2(octaves); f <= 0.5; f *= 1.013) {
    const double ratio = fitted_spectrum(fit, tick_s, f) / flicker_spectrum(flicker, tick_s, f);
    ripple.least = std::min(ripple.least, ratio);
    ripple.greatest = std::max(ripple.greatest, ratio);
  }
  return ripple;
}

TEST(FlickerFitOfOneOverF, FollowsTheSpectrumWithinSixPercent) {
  // 0.94 to 1.06 to two digits; the least, 0.936, is at the slowest lag's corner.
  const Ripple ripple = measured_ripple(flicker_of_order(0.5), 1.0, 0.0);
  EXPECT_GT(ripple.least, 0.935);
  EXPECT_LT(ripple.greatest, 1.065);
}

TEST(FlickerFitOfAnyOrder, FollowsTheSpectrumAboveTheSlowestCorner) {
  for (const double order : {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}) {
    const Ripple ripple = measured_ripple(flicker_of_order(order), 1.0, 1.0);
    EXPECT_GT(ripple.least, 0.93) << "order " << order;
    EXPECT_LT(ripple.greatest, 1.07) << "order " << order;
  }
}

TEST(FlickerFitOfAnyOrder, ReportsTheRippleItHas) {
  // The fit's grid steps by 10 %, within which a sum of first-order lags relative to a power law
  // changes by a fraction of its own ripple.
  for (const double order : {0.3, 0.5, 0.7, 0.9}) {
    const Flicker flicker = flicker_of_order(order);
    const Ripple ripple = measured_ripple(flicker, 1.0, 0.0);
    const FlickerFit fit = fit_flicker(flicker, 1.0);
    EXPECT_NEAR(fit.least_ratio, ripple.least, 0.005) << "order " << order;
    EXPECT_NEAR(fit.greatest_ratio, ripple.greatest, 0.005) << "order " << order;
  }
}

TEST(FlickerFitOfAnyOrder, GivesNoNegativeVariance) {
  for (const double order : {0.01, 0.3, 0.5, 0.7, 0.9, 0.99}) {
    for (const double tick_s : {0.01, 0.5, 10.0}) {
      const FlickerFit fit = fit_flicker(flicker_of_order(order), tick_s);
      EXPECT_GE(std::ranges::min(fit.variances_rad2_s2), 0.0) << order << ' ' << tick_s;
      EXPECT_GE(fit.white_variance_rad2_s2, 0.0) << order << ' ' << tick_s;
    }
  }
}

TEST(FlickerFitOfOneOverF, GivesInteriorLagsKeshnersVariance) {
  // A sum of lags with time constants a factor rho apart and Allan floor s has the variance
  // s^2 ln(rho) / (2 ln 2) per lag. The lags at the two ends also stand for what lies beyond.
  const Flicker flicker = flicker_of_order(0.5);
  const double floor = std::sqrt(2.0 * std::numbers::ln2 / kPi) * flicker.bias_instability_rad_s;
  const double wanted = floor * floor * std::numbers::ln10 / (2.0 * std::numbers::ln2);
  const FlickerFit fit = fit_flicker(flicker, 1.0);
  for (std::size_t i = 2; i < 4; ++i) {
    EXPECT_NEAR(fit.variances_rad2_s2[i] / wanted, 1.0, 0.06) << "lag " << i;
  }
}

TEST(FlickerFitOfLouderNoise, ScalesWithItsSquare) {
  Flicker flicker = flicker_of_order(0.7);
  const FlickerFit once = fit_flicker(flicker, 0.1);
  flicker.bias_instability_rad_s *= 4.0;  // a power of two: exact
  const FlickerFit louder = fit_flicker(flicker, 0.1);
  for (std::size_t i = 0; i < once.variances_rad2_s2.size(); ++i) {
    EXPECT_DOUBLE_EQ(louder.variances_rad2_s2[i], 16.0 * once.variances_rad2_s2[i]);
  }
  EXPECT_DOUBLE_EQ(louder.white_variance_rad2_s2, 16.0 * once.white_variance_rad2_s2);
  EXPECT_EQ(louder.least_ratio, once.least_ratio);
}

TEST(FlickerFitAtAnotherRate, LeavesSlowLagsAsTheyAre) {
  // The lags are physical: whether the filter runs at 10 Hz or at 1 Hz, the hours are the same.
  const FlickerFit fast = fit_flicker(flicker_of_order(0.5), 0.1);
  const FlickerFit slow = fit_flicker(flicker_of_order(0.5), 1.0);
  for (std::size_t i = 3; i < 6; ++i) {
    EXPECT_NEAR(fast.variances_rad2_s2[i] / slow.variances_rad2_s2[i], 1.0, 0.05) << "lag " << i;
  }
}

TEST(FlickerFitWithSlowestLagBelowTheTick, IsRefused) {
  Flicker flicker = flicker_of_order(0.5);
  flicker.decades = 1;
  EXPECT_THROW((void)fit_flicker(flicker, 1.0), std::invalid_argument);
  EXPECT_THROW((void)fit_flicker(flicker, 0.0), std::invalid_argument);
  flicker.order = 1.0;
  EXPECT_THROW((void)fit_flicker(flicker, 0.1), std::invalid_argument);
}

TEST(NonnegativeLeastSquares, SatisfiesTheOptimalityConditions) {
  // Karush-Kuhn-Tucker: no gradient where x is positive, no descent where x is zero.
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(12, 6, [&] { return normal(random); });
    const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(12, [&] { return normal(random); });
    const Eigen::VectorXd x = nonnegative_least_squares(A, b);
    const Eigen::VectorXd descent = A.transpose() * (b - A * x);
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      ASSERT_GE(x(i), 0.0);
      if (x(i) > 0.0) {
        ASSERT_NEAR(descent(i), 0.0, 1e-11);
      } else {
        ASSERT_LT(descent(i), 1e-11);
      }
    }
  }
}

}  // namespace
}  // namespace zerorate::model

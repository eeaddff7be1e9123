#include "host_tools/lib/identify/whittle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::identify {
namespace {

std::vector<double> noise(const std::vector<simulate::Effect>& effects) {
  return simulate::simulate(simulate::Signal(5000, 1.0), effects, random::RandomStream(20120416))
      .rate_rad_s;
}

TEST(DctPowerRatio, IsOneForWhiteNoiseAndForARandomWalk) {
  for (const std::size_t k : {1U, 2U, 7U, 32U}) {
    EXPECT_NEAR(dct_power_ratio(0.0, k), 1.0, 1e-6);
    EXPECT_NEAR(dct_power_ratio(1.0, k), 1.0, 1e-6);
    EXPECT_NEAR(dct_power_ratio(0.5 - 1e-6, k), dct_power_ratio(0.5, k), 1e-5);
  }
}

// From the spectrum instead of the covariance, by the midpoint rule over a finely cut frequency
// axis: |C_k(w)|^2 = 4 w^2 (1 - (-1)^k cos w) / (w^2 - p^2)^2, p = pi k, and 1 / (2 pi) of it, both
// signs.
TEST(DctPowerRatio, EqualsTheIntegralOverTheSpectrum) {
  for (const double order : {0.3, 0.5, 0.8}) {
    for (const int k : {1, 2, 3}) {
      const double p = std::numbers::pi * k;
      constexpr double kStep = 1e-3;
      double sum = 0.0;
      for (int i = 0; i < 2'000'000; ++i) {
        const double w = (i + 0.5) * kStep;
        const double difference = w * w - p * p;
        const double cosine = (k % 2 == 0 ? 1.0 : -1.0) * std::cos(w);
        sum += w * w * (1.0 - cosine) / (difference * difference) * std::pow(w / p, -2.0 * order);
      }
      EXPECT_NEAR(dct_power_ratio(order, static_cast<std::size_t>(k)),
                  4.0 / std::numbers::pi * sum * kStep, 3e-3)
          << order << ' ' << k;
    }
  }
}

TEST(WhiteFlickerFit, ScalesWithTheRate) {
  std::vector<double> rate = noise({simulate::WhiteNoise{1.0}, simulate::FlickerNoise{0.5}});
  const WhiteFlickerFit fit = fit_white_flicker(rate);
  for (double& value : rate) value = 1e-4 * value + 0.2;
  const WhiteFlickerFit scaled = fit_white_flicker(rate);
  ASSERT_TRUE(fit.flicker && scaled.flicker);
  EXPECT_NEAR(scaled.white_variance.value / fit.white_variance.value, 1e-8, 1e-12);
  EXPECT_NEAR(scaled.flicker->order.value, fit.flicker->order.value, 1e-4);
  EXPECT_NEAR(scaled.likelihood_ratio, fit.likelihood_ratio, 1e-3);
}

// Two standard errors of the variance of 4999 coefficients, sqrt(2 / 4999), are 4 %.
TEST(WhiteFlickerFit, AnswersThatThereIsNoFlicker) {
  const WhiteFlickerFit fit = fit_white_flicker(noise({simulate::WhiteNoise{1.0}}));
  EXPECT_FALSE(fit.flicker.has_value());
  EXPECT_GT(fit.p_value, 0.01);
  EXPECT_NEAR(fit.white_variance.value, 1.0, 0.08);
}

TEST(WhiteFlickerFit, FindsFlickerWithoutWhiteNoise) {
  const WhiteFlickerFit fit = fit_white_flicker(noise({simulate::FlickerNoise{1.0}}));
  ASSERT_TRUE(fit.flicker.has_value());
  EXPECT_LT(fit.white_variance.value, 5.0 * fit.white_variance.standard_error);
  EXPECT_NEAR(fit.flicker->order.value, 0.5, 5.0 * fit.flicker->order.standard_error);
}

TEST(WhiteFlickerFit, RefusesWhatItCannotFit) {
  EXPECT_THROW((void)fit_white_flicker(std::vector<double>(63)), recording::DataError);
  std::vector<double> rate(100, 1.0);
  EXPECT_THROW((void)fit_white_flicker(rate), recording::DataError);
  rate[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)fit_white_flicker(rate), recording::DataError);
}

std::vector<double> flicker(std::size_t samples) {
  const std::vector<simulate::Effect> effects{simulate::FlickerNoise{1.0}};
  return simulate::simulate(simulate::Signal(samples, 1.0), effects, random::RandomStream(20120416))
      .rate_rad_s;
}

TEST(LocalWhittle, DoesNotSeeScaleAndBias) {
  std::vector<double> rate = flicker(1000);
  const Estimate plain = exact_local_whittle(rate, 80);
  for (double& value : rate) value = 1e-4 * value + 0.3;
  EXPECT_NEAR(exact_local_whittle(rate, 80).value, plain.value, 1e-4);
}

TEST(LocalWhittle, StatesAnErrorThatTendsToItsLimit) {
  const double limit = 0.5 / std::sqrt(2000.0);
  const double stated = exact_local_whittle(flicker(100'000), 2000).standard_error;
  EXPECT_GT(stated, limit);
  EXPECT_LT(stated, 1.02 * limit);
}

TEST(LocalWhittle, RefusesWhatHasNoOrder) {
  std::vector<double> rate = flicker(100);
  EXPECT_THROW((void)exact_local_whittle(rate, 1), std::invalid_argument);
  EXPECT_THROW((void)exact_local_whittle(rate, 50), std::invalid_argument);
  EXPECT_THROW((void)exact_local_whittle({}, 10), std::invalid_argument);
  rate[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)exact_local_whittle(rate, 10), recording::DataError);
  EXPECT_THROW((void)exact_local_whittle(std::vector<double>(100, 0.1), 10), recording::DataError);
}

}  // namespace
}  // namespace zerorate::identify

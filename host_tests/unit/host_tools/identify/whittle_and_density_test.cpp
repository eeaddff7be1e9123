#include "host_tools/lib/identify/whittle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "host_tools/lib/identify/density.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::identify {
namespace {

std::vector<double> noise(const std::vector<simulate::Effect>& effects) {
  return simulate::simulate(simulate::Signal(5000, 1.0), effects, random::RandomStream(20120416))
      .rate_rad_s;
}

TEST(DctPowerRatios, IsOneForWhiteNoiseAndForARandomWalk) {
  for (std::size_t k = 0; k < kDctRatios; ++k) {
    EXPECT_EQ(dct_power_ratios(0.0)[k], 1.0);
    EXPECT_NEAR(dct_power_ratios(1.0)[k], 1.0, 1e-9) << k;
    EXPECT_NEAR(dct_power_ratios(0.5 - 1e-6)[k], dct_power_ratios(0.5)[k], 1e-5) << k;
  }
}

// From the spectrum instead of the covariance, by the midpoint rule over a finely cut frequency
// axis: |C_k(w)|^2 = 4 w^2 (1 - (-1)^k cos w) / (w^2 - p^2)^2, p = pi k, and 1 / (2 pi) of it, both
// signs.
TEST(DctPowerRatios, EqualsTheIntegralOverTheSpectrum) {
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
      EXPECT_NEAR(dct_power_ratios(order)[static_cast<std::size_t>(k - 1)],
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

constexpr double kSamplePeriod = 0.02;

std::vector<double> noise(std::size_t samples, const std::vector<simulate::Effect>& effects) {
  return simulate::simulate(simulate::Signal(samples, kSamplePeriod), effects,
                            random::RandomStream(20120416))
      .rate_rad_s;
}

double integral(const std::vector<DensityPoint>& points) {
  double sum = 0.0;
  for (const DensityPoint& point : points) sum += point.density * points.front().frequency_hz;
  return sum;
}

TEST(Periodogram, IntegratesToTheVariance) {
  const std::vector<double> rate =
      noise(1000, {simulate::WhiteNoise{1.0}, simulate::ConstantBias{7.0}});
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : rate) {
    sum += value;
    squares += value * value;
  }
  const double variance = squares / 1000.0 - sum * sum / 1e6;
  EXPECT_NEAR(integral(periodogram(rate, kSamplePeriod)), variance, 1e-11 * variance);
}

TEST(Periodogram, PutsALineIntoItsBin) {
  const auto points =
      periodogram(noise(1000, {simulate::PeriodicDisturbance{3.0, 10.0}}), kSamplePeriod);
  ASSERT_EQ(points.size(), 500U);
  EXPECT_DOUBLE_EQ(points[199].frequency_hz, 10.0);
  EXPECT_NEAR(points[199].density * 0.05, 4.5, 1e-9);  // half the squared amplitude
  EXPECT_NEAR(points[198].density, 0.0, 1e-9);
}

// The mean of all bins of s segments has a relative error of about sqrt(1 / samples).
TEST(WelchDensity, OfWhiteNoiseIsTwiceTheSquaredAngleRandomWalk) {
  constexpr std::size_t kSamples = 200'000;
  const auto points =
      welch_density(noise(kSamples, {simulate::WhiteNoise{0.3}}), kSamplePeriod, 256);
  EXPECT_EQ(points.size(), 128U);
  EXPECT_DOUBLE_EQ(points.back().frequency_hz, 25.0);
  double mean = 0.0;
  for (std::size_t j = 1; j + 1 < points.size(); ++j) mean += points[j].density / 126.0;
  EXPECT_NEAR(mean / (2.0 * 0.3 * 0.3), 1.0, 5.0 * std::sqrt(2.0 / kSamples));
}

TEST(WelchDensity, RefusesSegmentsThatDoNotFit) {
  const std::vector<double> rate(100);
  EXPECT_THROW((void)welch_density(rate, 1.0, 101), std::invalid_argument);
  EXPECT_THROW((void)welch_density(rate, 1.0, 102), std::invalid_argument);
  EXPECT_THROW((void)welch_density(rate, 1.0, 0), std::invalid_argument);
  EXPECT_THROW((void)periodogram(std::vector<double>(1), 1.0), recording::DataError);
}

TEST(LogarithmicBins, KeepEveryPointOnceAndAverage) {
  const std::vector<DensityPoint> points{{1.0, 4.0}, {1.5, 6.0}, {20.0, 1.0}, {30.0, 3.0}};
  const auto bins = bin_logarithmically(points, 2.0);
  ASSERT_EQ(bins.size(), 2U);
  EXPECT_DOUBLE_EQ(bins[0].frequency_hz, 1.25);
  EXPECT_DOUBLE_EQ(bins[0].density, 5.0);
  EXPECT_DOUBLE_EQ(bins[1].frequency_hz, 25.0);
  EXPECT_EQ(bins[1].points, 2U);
  EXPECT_TRUE(bin_logarithmically({}, 2.0).empty());
}

}  // namespace
}  // namespace zerorate::identify

#include "host_tools/lib/identify/density.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::identify {
namespace {

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

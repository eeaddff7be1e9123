#include "host_tools/lib/identify/allan_deviation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::identify {
namespace {

using random::RandomStream;
using simulate::Effect;
using simulate::Signal;

// Half the mean square difference of neighbouring averages, every average summed anew.
double by_definition(const std::vector<double>& rate, std::size_t m) {
  long double sum = 0.0L;
  const std::size_t terms = rate.size() - 2 * m + 1;
  for (std::size_t k = 0; k < terms; ++k) {
    long double difference = 0.0L;
    for (std::size_t i = 0; i < m; ++i) {
      difference +=
          static_cast<long double>(rate[k + m + i]) - static_cast<long double>(rate[k + i]);
    }
    sum += difference * difference;
  }
  const auto factor = static_cast<long double>(m);
  return static_cast<double>(sum / (2.0L * factor * factor * static_cast<long double>(terms)));
}

std::vector<double> noise(std::size_t samples, std::vector<Effect> effects) {
  return simulate::simulate(Signal(samples, 1.0), effects, random::RandomStream(20120416))
      .rate_rad_s;
}

TEST(AllanVariance, EqualsTheDefinitionDespiteAHugeBias) {
  const std::vector<double> rate =
      noise(5000, {simulate::WhiteNoise{1.0}, simulate::ConstantBias{1e6}});
  const std::vector<std::size_t> factors{1, 2, 3, 10, 100, 999, 2047, 2500};
  const std::vector<double> variances = allan_variances(rate, factors);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const double expected = by_definition(rate, factors[i]);
    EXPECT_NEAR(variances[i], expected, 1e-10 * expected) << factors[i];
  }
}

// NIST SP 1065, section 12.4 (the set of Riley's test suite): 1000 points of a linear congruential
// generator, n_{i+1} = 16807 n_i mod 2147483647, n_0 = 1234567890, divided by 2147483647, as
// frequencies; table 31 gives the overlapping Allan deviation.
TEST(AllanDeviation, EqualsThePublishedTestSuite) {
  std::vector<double> frequency(1000);
  std::uint64_t n = 1234567890;
  for (double& y : frequency) {
    y = static_cast<double>(n) / 2147483647.0;
    n = 16807 * n % 2147483647;
  }
  const std::vector<std::size_t> factors{1, 10, 100};
  const std::vector<double> variances = allan_variances(frequency, factors);
  EXPECT_NEAR(std::sqrt(variances[0]), 2.922319e-1, 5e-8);
  EXPECT_NEAR(std::sqrt(variances[1]), 9.159953e-2, 5e-9);
  EXPECT_NEAR(std::sqrt(variances[2]), 3.241343e-2, 5e-9);
}

TEST(AllanDeviation, OfARampIsTheRampsClosedForm) {
  const std::vector<double> rate = noise(1000, {simulate::RateRamp{0.002}});
  for (const AllanPoint& point : allan_deviation(rate, 1.0)) {
    EXPECT_NEAR(point.adev, 0.002 * point.tau_s / std::sqrt(2.0), 1e-12);
  }
}

TEST(AllanDeviation, CarriesTheSamplePeriodInTauOnly) {
  const std::vector<double> rate = noise(1000, {simulate::WhiteNoise{1.0}});
  const auto slow = allan_deviation(rate, 1.0);
  const auto fast = allan_deviation(rate, 0.01);
  ASSERT_EQ(slow.size(), fast.size());
  for (std::size_t i = 0; i < slow.size(); ++i) {
    EXPECT_DOUBLE_EQ(fast[i].tau_s, 0.01 * slow[i].tau_s);
    EXPECT_EQ(fast[i].adev, slow[i].adev);
  }
}

TEST(AllanDeviation, OrdersItsIntervalsAndLosesFreedomWithTau) {
  const auto points = allan_deviation(noise(10'000, {simulate::WhiteNoise{1.0}}), 1.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT(points[i].lo, points[i].adev);
    EXPECT_LT(points[i].adev, points[i].hi);
    if (i > 4) {
      EXPECT_LT(points[i].edf, points[i - 1].edf);
    }
  }
}

TEST(AllanDeviation, OfAConstantIsZero) {
  for (const AllanPoint& point : allan_deviation(std::vector<double>(100, 3.0), 1.0)) {
    EXPECT_EQ(point.adev, 0.0);
    EXPECT_EQ(point.hi, 0.0);
  }
}

TEST(AllanDeviation, RefusesWhatItCannotJudge) {
  EXPECT_THROW((void)allan_deviation(std::vector<double>(7), 1.0), recording::DataError);
  std::vector<double> rate(100);
  rate[50] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)allan_deviation(rate, 1.0), recording::DataError);
  rate[50] = 0.0;
  const std::vector<std::size_t> too_long{51};
  EXPECT_THROW((void)allan_variances(rate, too_long), std::invalid_argument);
}

TEST(AveragingFactors, GrowFromOneToAThirdWithoutRepetition) {
  const auto factors = averaging_factors(10'000'000, 16.0);
  EXPECT_EQ(factors.front(), 1U);
  EXPECT_LE(factors.back(), 10'000'000U / 3);
  EXPECT_GT(factors.back(), 10'000'000U / 4);
  for (std::size_t i = 1; i < factors.size(); ++i) EXPECT_LT(factors[i - 1], factors[i]);
}

TEST(PowerLaw, IsRecognisedFromAThousandAverages) {
  const auto identified = [](Effect effect) { return identify_power_law(noise(1000, {effect})); };
  EXPECT_EQ(identified(simulate::WhiteNoise{1.0}), PowerLaw::rate_white);
  EXPECT_EQ(identified(simulate::FlickerNoise{1.0}), PowerLaw::rate_flicker);
  EXPECT_EQ(identified(simulate::RateRandomWalk{1.0}), PowerLaw::rate_random_walk);
  std::vector<double> angle = noise(1001, {simulate::WhiteNoise{1.0}});
  for (std::size_t k = 0; k + 1 < angle.size(); ++k) angle[k] = angle[k + 1] - angle[k];
  angle.pop_back();
  EXPECT_EQ(identify_power_law(angle), PowerLaw::angle_white);
}

}  // namespace
}  // namespace zerorate::identify

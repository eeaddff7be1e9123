#include "host_tools/lib/identify/local_whittle.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::identify {
namespace {

using simulate::Effect;

constexpr std::size_t kSamples = 2000;

struct Spread {
  double mean;
  double deviation;
  double stated_error;
};

Spread estimates(std::size_t runs, std::size_t frequencies, const std::vector<Effect>& effects) {
  double sum = 0.0;
  double squares = 0.0;
  double stated = 0.0;
  for (std::size_t run = 0; run < runs; ++run) {
    const simulate::Signal signal =
        simulate::simulate(simulate::Signal(kSamples, 1.0), effects, random::RandomStream(1, run));
    const Estimate order = exact_local_whittle(signal.rate_rad_s, frequencies);
    sum += order.value;
    squares += order.value * order.value;
    stated = order.standard_error;
  }
  const auto count = static_cast<double>(runs);
  const double mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean), stated};
}

// The standard error of the mean of 1000 is 0.0015, that of their deviation 2.2 %: the tolerances,
// 0.01 and 10 %, leave room for the estimator's own small-sample errors.
void expect_unbiased_with_its_stated_error(const Spread& spread) {
  EXPECT_NEAR(spread.mean, 0.5, 0.01);
  EXPECT_NEAR(spread.deviation / spread.stated_error, 1.0, 0.1);
}

TEST(LocalWhittle, IsUnbiasedWithItsStatedErrorAtOrderHalf) {
  constexpr std::size_t kFrequencies = 139;  // n^0.65
  ASSERT_EQ(local_whittle_bandwidth(kSamples), kFrequencies);
  for (const double history : {0.0, 4.0}) {
    const Spread spread =
        estimates(1000, kFrequencies, {simulate::FlickerNoise{1.0, 0.5, history}});
    expect_unbiased_with_its_stated_error(spread);
    // Here the limit for many frequencies, 1 / (2 sqrt(m)), is within 10 % too: 6.5 % too low.
    EXPECT_NEAR(spread.deviation * 2.0 * std::sqrt(double{kFrequencies}), 1.0, 0.1) << history;
  }
}

// With n^0.5 the limit is 15 % too low: its relative error is about log(m) / m, because the sum of
// (log gain - mean)^2 tends to m slowly.
TEST(LocalWhittle, StatesItsErrorWithFewFrequenciesToo) {
  constexpr std::size_t kFrequencies = 44;
  const Spread spread = estimates(1000, kFrequencies, {simulate::FlickerNoise{1.0, 0.5, 0.0}});
  expect_unbiased_with_its_stated_error(spread);
  EXPECT_GT(spread.stated_error * 2.0 * std::sqrt(double{kFrequencies}), 1.1);
}

// 0.0049 is four standard errors of the mean of 100 runs with 800 frequencies; the sample mean
// costs another 0.01 towards order 1.
TEST(LocalWhittle, FollowsTheOrder) {
  for (const double order : {-0.2, 0.0, 0.3, 0.7, 0.9}) {
    const Spread spread = estimates(100, 800, {simulate::FlickerNoise{1.0, order, 4.0}});
    EXPECT_NEAR(spread.mean, order, 0.01 + 4.0 * spread.stated_error / 10.0) << order;
  }
}

// White noise flattens the spectrum above the corner: the estimate falls towards 0 as frequencies
// from there are taken in (Deo and Hurvich 2001). Ten standard errors of the mean are a clear fall.
TEST(LocalWhittle, IsPulledDownByAddedWhiteNoiseAboveTheCorner) {
  const std::vector<Effect> effects{simulate::WhiteNoise{1.0}, simulate::FlickerNoise{1.0}};
  const Spread below = estimates(200, 40, effects);  // the corner, 1/(2 pi), is at index 318
  const Spread across = estimates(200, 800, effects);
  EXPECT_LT(across.mean, 0.5 - 10.0 * across.stated_error / std::sqrt(200.0));
  EXPECT_LT(across.mean, below.mean - 10.0 * below.stated_error / std::sqrt(200.0));
}

}  // namespace
}  // namespace zerorate::identify

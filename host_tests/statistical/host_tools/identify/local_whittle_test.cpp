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
    const simulate::Signal signal = simulate::simulate(simulate::Signal(kSamples, 1.0), effects,
                                                       simulate::RandomStream(20120416, run));
    const Estimate order = exact_local_whittle(signal.rate_rad_s, frequencies);
    sum += order.value;
    squares += order.value * order.value;
    stated = order.standard_error;
  }
  const auto count = static_cast<double>(runs);
  const double mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean), stated};
}

// The standard error of the mean of 1000 is .0015, that of their deviation 2.2 %: the tolerances,
// .01 and 10 %, leave room for the estimator's own small-sample errors.
TEST(LocalWhittle, IsUnbiasedWithItsStatedErrorAtOrderHalf) {
  for (const double history : {0.0, 4.0}) {
    const Spread spread = estimates(1000, local_whittle_bandwidth(kSamples),
                                    {simulate::FlickerNoise{1.0, 0.5, history}});
    EXPECT_NEAR(spread.mean, 0.5, 0.01) << history;
    EXPECT_NEAR(spread.deviation / spread.stated_error, 1.0, 0.1) << history;
  }
}

// .0049 is four standard errors of the mean of 100 runs with 800 frequencies; the sample mean costs
// another .01 towards order 1.
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

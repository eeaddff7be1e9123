#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "host_tools/lib/identify/whittle.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::identify {
namespace {

using simulate::Effect;

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kRuns = 200;
constexpr std::size_t kSamples = 20'000;
constexpr double kWhite = 1.0;
constexpr double kFlicker = 0.3;  // white over flicker 3.3, as in the paper's sensor

std::vector<double> recording(std::size_t run, double flicker, double order) {
  const std::vector<Effect> effects{simulate::WhiteNoise{kWhite},
                                    simulate::FlickerNoise{flicker, order}};
  return simulate::simulate(simulate::Signal(kSamples, 1.0), effects,
                            random::RandomStream(kSeed, run))
      .rate_rad_s;
}

/// The strength of which this is the square.
Estimate root(const Estimate& square) {
  const double value = std::sqrt(square.value);
  return {value, 0.5 * square.standard_error / value};
}

/// Bias and coverage of 95 % intervals of one parameter.
struct Recovery {
  void add(const Estimate& estimate, double truth) {
    error += estimate.value - truth;
    stated += estimate.standard_error;
    held += std::abs(estimate.value - truth) < 1.96 * estimate.standard_error ? 1.0 : 0.0;
  }
  /// Unbiased within 2 %, or within three standard errors of the mean where the runs are too few to
  /// tell. Coverage within three standard deviations of a share of 200 at 0.95: 0.046.
  void expect_honest(const char* what, double truth) const {
    const double of_the_mean = stated / kRuns / std::sqrt(double{kRuns});
    EXPECT_NEAR(error / kRuns, 0.0, std::max(0.02 * truth, 3.0 * of_the_mean)) << what;
    EXPECT_NEAR(held / kRuns, 0.95, 3.0 * std::sqrt(0.95 * 0.05 / kRuns)) << what;
  }
  double error = 0.0;
  double stated = 0.0;
  double held = 0.0;
};

TEST(WhiteFlickerFit, RecoversStrengthsAndOrderWithHonestErrors) {
  for (const double order : {0.5, 0.7}) {
    std::array<Recovery, 3> recovery;
    for (std::size_t run = 0; run < kRuns; ++run) {
      const WhiteFlickerFit fit = fit_white_flicker(recording(run, kFlicker, order));
      ASSERT_TRUE(fit.flicker.has_value());
      recovery[0].add(root(fit.white_variance), kWhite);
      recovery[1].add(root(fit.flicker->innovation_variance), kFlicker);
      recovery[2].add(fit.flicker->order, order);
    }
    recovery[0].expect_honest("white noise", kWhite);
    recovery[1].expect_honest("flicker noise", kFlicker);
    recovery[2].expect_honest("order", order);
  }
}

TEST(WhiteFlickerFit, RecoversStrengthsWhereTheOrderIsGiven) {
  std::array<Recovery, 2> recovery;
  for (std::size_t run = 0; run < kRuns; ++run) {
    const WhiteFlickerFit fit = fit_white_flicker(recording(run, kFlicker, 0.5), {.order = 0.5});
    ASSERT_TRUE(fit.flicker.has_value());
    EXPECT_EQ(fit.flicker->order.standard_error, 0.0);
    recovery[0].add(root(fit.white_variance), kWhite);
    recovery[1].add(root(fit.flicker->innovation_variance), kFlicker);
  }
  recovery[0].expect_honest("white noise", kWhite);
  recovery[1].expect_honest("flicker noise", kFlicker);
}

// At a significance of 0.05, 200 clean recordings give 10 +- 3.1 alarms if the p-value is exact and
// fewer if it is conservative: at most four standard deviations more.
TEST(WhiteFlickerFit, InventsNoFlickerInWhiteNoise) {
  for (const std::optional<double> order : {std::optional<double>{}, std::optional<double>{0.5}}) {
    double alarms = 0.0;
    for (std::size_t run = 0; run < kRuns; ++run) {
      const WhiteFlickerFit fit =
          fit_white_flicker(recording(run, 0.0, 0.5), {.order = order, .significance = 0.05});
      alarms += fit.flicker ? 1.0 : 0.0;
    }
    EXPECT_LE(alarms, 0.05 * kRuns + 4.0 * std::sqrt(0.05 * 0.95 * kRuns)) << order.has_value();
  }
}

constexpr std::size_t kLocalSamples = 2000;

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
    const simulate::Signal signal = simulate::simulate(simulate::Signal(kLocalSamples, 1.0),
                                                       effects, random::RandomStream(1, run));
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
  ASSERT_EQ(local_whittle_bandwidth(kLocalSamples), kFrequencies);
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

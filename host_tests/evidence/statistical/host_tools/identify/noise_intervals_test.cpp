// Intervals of N, B and d over weak and strong 1/f noise, sample rates and lengths, from two
// generators: the product's, and a sum of exponentially correlated processes.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "host_tests/support/repetitions.hpp"
#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/identify/characterize.hpp"

namespace zerorate::identify {
namespace {

using zerorate::testing::kRadPerDeg;
using zerorate::testing::rest_samples_of;
using zerorate::testing::RestNoise;

/// Recordings of each case; in the slow run also longer and faster ones.
const std::uint64_t kRuns = zerorate::testing::repetitions(4);
const bool kIsSlow = kRuns >= 100;

struct Case {
  RestNoise noise;
  double rate_hz;
  double length_s;

  [[nodiscard]] std::size_t samples() const { return static_cast<std::size_t>(rate_hz * length_s); }
};

/// Where the 1/f noise of a sample is more than a tenth of its white noise, N depends on the
/// sensor's low-pass.
bool has_one_meaning(const Case& one) {
  const double n = one.noise.angle_random_walk_dps_per_sqrt_hz;
  const double b = one.noise.bias_instability_dph / 3600.0;
  return b * b < 0.1 * n * n * one.rate_hz;
}

/// Corners of white and 1/f noise at 0.004, 0.1 and 0.5 Hz, for d = 1/2.
std::vector<Case> grid() {
  std::vector<Case> cases;
  const std::vector<double> rates =
      kIsSlow ? std::vector{10.0, 100.0, 1000.0} : std::vector{10.0, 100.0};
  const std::vector<double> lengths =
      kIsSlow ? std::vector{600.0, 3600.0, 10'800.0} : std::vector{600.0, 3600.0};
  for (const double rate_hz : rates) {
    for (const double length_s : lengths) {
      for (const double floor_dph : {1.6, 8.0, 18.0}) {
        for (const double order : {0.5, 0.6}) {
          const Case one{{.angle_random_walk_dps_per_sqrt_hz = 0.004,
                          .bias_instability_dph = floor_dph / 0.664,
                          .order = order},
                         rate_hz,
                         length_s};
          if (has_one_meaning(one)) cases.push_back(one);
        }
      }
    }
  }
  return cases;
}

/// @param seed another for each recording of the grid
using Generator = std::function<simulate::Signal(const Case&, std::uint64_t seed)>;

simulate::Signal product_signal(const Case& one, std::uint64_t seed) {
  return zerorate::testing::simulate_rest(one.noise, one.samples(), 1.0 / one.rate_hz, seed);
}

/// White noise and exponentially correlated processes, each with three times the time constant of
/// the one before, from a third of the sample period, whose corner is half the sample rate, to
/// sixteen times the recording. The density of their sum is B^2 omega^(-2d) where the variance of
/// each is B^2 ln(3) sin(pi d) / pi tau^(2d - 1).
simulate::Signal sum_of_lags(const Case& one, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  const double period_s = 1.0 / one.rate_hz;
  simulate::Signal signal(one.samples(), period_s);
  const double white =
      one.noise.angle_random_walk_dps_per_sqrt_hz * kRadPerDeg / std::sqrt(period_s);
  for (double& rate : signal.rate_rad_s) rate += white * normal(engine);
  const double order = one.noise.order;
  const double b = one.noise.bias_instability_dph / 3600.0 * kRadPerDeg;
  for (double tau_s = period_s / 3.0; tau_s < 16.0 * one.length_s; tau_s *= 3.0) {
    const double sigma = b * std::sqrt(std::log(3.0) * std::sin(std::numbers::pi * order) /
                                       std::numbers::pi * std::pow(tau_s, 2.0 * order - 1.0));
    const double kept = std::exp(-period_s / tau_s);
    const double step = sigma * std::sqrt(-std::expm1(-2.0 * period_s / tau_s));
    double value = sigma * normal(engine);
    for (double& rate : signal.rate_rad_s) {
      rate += value;
      value = kept * value + step * normal(engine);
    }
  }
  return signal;
}

class Coverage {
 public:
  void add(const IntervalEstimate& estimate, double truth) {
    ++runs_;
    if (estimate.lo <= truth && truth <= estimate.hi) ++held_;
  }

  /// 0.92 to 0.98, and three standard deviations of a share of so few runs.
  void expect_honest(const char* what) const {
    const double share = held_ / runs_;
    std::printf("%-16s %.3f of %.0f\n", what, share, runs_);
    const double chance = 3.0 * std::sqrt(0.95 * 0.05 / runs_);
    EXPECT_GE(share, 0.92 - chance) << what;
    EXPECT_LE(share, 0.98 + chance) << what;
  }

 private:
  double runs_ = 0.0;
  double held_ = 0.0;
};

void expect_honest_intervals(const Generator& generate) {
  Coverage white;
  Coverage white_of_ieee;
  Coverage flicker;
  Coverage order;
  std::uint64_t seed = 1;
  for (const Case& one : grid()) {
    const double n = one.noise.angle_random_walk_dps_per_sqrt_hz * kRadPerDeg;
    const double b = one.noise.bias_instability_dph / 3600.0 * kRadPerDeg;
    for (std::uint64_t run = 0; run < kRuns; ++run) {
      const Characterization result =
          characterize(rest_samples_of(generate(one, seed++)), {.recording = "run", .axes = {0}});
      const InnovationsFit& fit = result.axes.front().fit;
      white.add(fit.angle_random_walk_rad_per_sqrt_s, n);
      // B of a wrong order has another meaning, and weak noise that was found is a choice of runs.
      if (!fit.flicker || one.noise.bias_instability_dph < 5.0) continue;
      if (fit.flicker->order_source == OrderSource::estimated || one.noise.order == 0.5) {
        flicker.add(fit.flicker->bias_instability_rad_s, b);
      }
      order.add(fit.flicker->rejected_order.value_or(fit.flicker->order), one.noise.order);
      if (one.noise.order == 0.5) {
        white_of_ieee.add(result.axes.front().coefficients.angle_random_walk_rad_per_sqrt_s, n);
      }
    }
  }
  white.expect_honest("N");
  white_of_ieee.expect_honest("N of N, B and K");
  flicker.expect_honest("B");
  order.expect_honest("d");
}

TEST(NoiseIntervals, HoldAtEveryRatioOfFlickerToWhiteNoise) {
  expect_honest_intervals(product_signal);
}

TEST(NoiseIntervals, HoldForNoiseThatAnotherGeneratorMade) {
  expect_honest_intervals(sum_of_lags);
}

}  // namespace
}  // namespace zerorate::identify

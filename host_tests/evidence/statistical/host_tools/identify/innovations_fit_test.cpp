#include "host_tools/lib/identify/innovations_fit.hpp"
#include "host_tests/support/repetitions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <vector>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/identify/characterize.hpp"

namespace zerorate::identify {
namespace {

using zerorate::testing::kRadPerDeg;
using zerorate::testing::rest_samples_of;
using zerorate::testing::RestNoise;
using zerorate::testing::simulate_rest;

/// 1000, or fewer in the default run, which says less (see the tolerances).
const std::size_t kCount = zerorate::testing::repetitions(40);
const auto kRuns = static_cast<double>(kCount);

/// Simulated noise. A record of ARFIMA noise at one sample a tick agrees with the filter's model
/// it is; with several samples a tick, averaging and aliasing bend the flicker noise just below
/// the tick's rate, which is some tenths of a percent of the white noise and more if it is weak.
struct Scenario {
  RestNoise noise;
  std::size_t samples;
  double period_s;
  std::optional<double> order{};  ///< order given to the fit
  std::size_t stop = 0;           ///< length in samples; 0: at rest all the time
};

InnovationsFit characterize_run(const simulate::Signal& signal, std::optional<double> order) {
  return characterize(rest_samples_of(signal), {.recording = "run", .axes = {0}, .order = order})
      .axes.front()
      .fit;
}

/// The error of one parameter over all runs.
class Recovery {
 public:
  explicit Recovery(double truth) : truth_(truth) {}

  void add(const IntervalEstimate& estimate) {
    error_ += estimate.value - truth_;
    squared_error_ += (estimate.value - truth_) * (estimate.value - truth_);
    stated_ += estimate.standard_error;
    held_ += estimate.lo <= truth_ && truth_ <= estimate.hi ? 1.0 : 0.0;
  }

  /// Unbiased within 2 %, or within the chance of the mean (3 standard errors) where the runs are
  /// too few to tell; coverage of 0.93 to 0.97, or within three standard deviations of a share at
  /// 0.95, which are 0.021 of 1000 runs.
  void expect_honest(const char* what) const {
    const double bias = error_ / kRuns;
    const double spread = std::sqrt(squared_error_ / kRuns - bias * bias);
    const double coverage = held_ / kRuns;
    std::printf("%-20s bias %+.2f %% +- %.2f, spread over stated error %.3f, coverage %.3f\n", what,
                100.0 * bias / truth_, 100.0 * spread / truth_ / std::sqrt(kRuns),
                spread / (stated_ / kRuns), coverage);
    const double error_of_bias = spread / std::sqrt(kRuns);
    EXPECT_NEAR(bias, 0.0, std::max(0.02 * truth_, 3.0 * error_of_bias)) << what;
    EXPECT_NEAR(coverage, 0.95, std::max(0.02, 3.0 * std::sqrt(0.95 * 0.05 / kRuns))) << what;
  }

 private:
  double truth_;
  double error_ = 0.0;
  double squared_error_ = 0.0;
  double stated_ = 0.0;
  double held_ = 0.0;
};

void expect_recovery(const Scenario& scenario) {
  const RestNoise& noise = scenario.noise;
  Recovery white(noise.angle_random_walk_dps_per_sqrt_hz * kRadPerDeg);
  Recovery flicker(noise.bias_instability_dph / 3600.0 * kRadPerDeg);
  Recovery free_order(noise.order);
  for (std::size_t run = 0; run < kCount; ++run) {
    simulate::Signal signal = simulate_rest(noise, scenario.samples, scenario.period_s, run);
    if (scenario.stop > 0) zerorate::testing::drop_drives(signal, scenario.stop);
    const InnovationsFit fit = characterize_run(signal, scenario.order);
    ASSERT_TRUE(fit.flicker.has_value()) << run;
    white.add(fit.angle_random_walk_rad_per_sqrt_s);
    flicker.add(fit.flicker->bias_instability_rad_s);
    if (!scenario.order) free_order.add(fit.flicker->rejected_order.value_or(fit.flicker->order));
  }
  white.expect_honest("white noise");
  flicker.expect_honest("flicker noise");
  if (!scenario.order) free_order.expect_honest("order");
}

TEST(InnovationsFit, RecoversFlickerNoiseWithHonestIntervals) {
  // 5000 s at 10 Hz: 10,000 ticks of five samples, the noise of a consumer gyro.
  expect_recovery({.noise = {}, .samples = 50'000, .period_s = 0.1, .order = 0.5});
}

TEST(InnovationsFit, RecoversStrengthsFromStopsBetweenDrives) {
  // Stops of 40 s and drives of 80 s over 4 h: 10,000 ticks at rest.
  expect_recovery({.noise = {.bias_instability_dph = 60.0},
                   .samples = 30'000,
                   .period_s = 0.5,
                   .order = 0.5,
                   .stop = 80});
}

TEST(InnovationsFit, RecoversTheOrderToo) {
  // 3 h with strong flicker noise, so that every record can tell its order.
  expect_recovery(
      {.noise = {.bias_instability_dph = 60.0, .order = 0.6}, .samples = 20'000, .period_s = 0.5});
}

TEST(InnovationsFit, CallsWhiteNoiseFlickerAsRarelyAsItSays) {
  std::size_t alarms = 0;
  for (std::size_t run = 0; run < kCount; ++run) {
    const auto signal = simulate_rest({.bias_instability_dph = 0.0}, 5'000, 0.1, run);
    if (characterize_run(signal, std::nullopt).flicker) ++alarms;
  }
  std::printf("false alarms: %zu of %zu\n", alarms, kCount);
  // 1 % and three standard deviations of a count: 19 of 1000.
  const double expected = 0.01 * kRuns;
  EXPECT_LE(static_cast<double>(alarms), expected + 3.0 * std::sqrt(expected));
}

/// Tick means of a simulated recording, which outlive AxisTicks.
struct SimulatedTicks {
  explicit SimulatedTicks(const RestNoise& noise, std::uint64_t run)
      : means(average_ticks(rest_samples_of(simulate_rest(noise, 300, 0.5, run)), kTick)) {}
  [[nodiscard]] AxisTicks axis() const { return {means, kTick, kTick, 0}; }

  static constexpr core::Duration kTick = core::Duration::milliseconds(500);
  std::vector<TickMean> means;
};

double p_value_of_three(const RestNoise& other, std::uint64_t run) {
  const SimulatedTicks first({}, 1000 + 3 * run);
  const SimulatedTicks second({}, 1001 + 3 * run);
  const SimulatedTicks third(other, 1002 + 3 * run);
  const std::vector<AxisTicks> all{first.axis(), second.axis(), third.axis()};
  const Sameness sameness = test_sameness(all, 0.5);
  EXPECT_EQ(sameness.degrees_of_freedom, 4U);
  EXPECT_EQ(sameness.alone.size(), 3U);
  return sameness.p_value;
}

TEST(SamenessOfAnUnchangedSensor, IsRejectedAsOftenAsItsSizeSays) {
  constexpr int kTriples = 30;
  int below_tenth = 0;
  int below_half = 0;
  for (int run = 0; run < kTriples; ++run) {
    const double p = p_value_of_three({}, static_cast<std::uint64_t>(run));
    if (p < 0.1) ++below_tenth;
    if (p < 0.5) ++below_half;
  }
  // Binomial, four standard deviations: 3 +- 4 * 1.64 and 15 +- 4 * 2.74.
  EXPECT_LE(below_tenth, 9);
  EXPECT_GE(below_half, 4);
  EXPECT_LE(below_half, 26);
}

TEST(SamenessOfASensorThatChanged, IsRejected) {
  // White noise is known to 1 / sqrt(2 n) = 4.1 % of 300 ticks: a half more is twelve of that.
  EXPECT_LT(p_value_of_three({.angle_random_walk_dps_per_sqrt_hz = 0.06}, 0), 1e-6);
  EXPECT_LT(p_value_of_three({.bias_instability_dph = 250.0}, 1), 1e-6);
}

}  // namespace
}  // namespace zerorate::identify

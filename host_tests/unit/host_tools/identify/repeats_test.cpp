#include "host_tools/lib/identify/repeats.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

namespace zerorate::identify {
namespace {

using ::testing::IsEmpty;

/// White noise of a sensor at 50 Hz in steps, as a logger reads it that polls at `polls_hz`.
RestSamples polled(double polls_hz, double sigma_in_steps, std::size_t axes = 1) {
  constexpr std::int64_t kSeconds = 60;
  std::mt19937_64 random{23};
  std::normal_distribution<double> noise;
  std::vector<std::array<float, 3>> measured(50 * kSeconds);
  for (auto& rates : measured) {
    for (std::size_t i = 0; i < axes; ++i)
      rates[i] = static_cast<float>(std::round(sigma_in_steps * noise(random)));
  }
  RestSamples samples{.axis_count = axes};
  samples.sample_period = core::Duration::nanoseconds(std::llround(1e9 / polls_hz));
  samples.mean_period = samples.sample_period;
  for (std::int64_t k = 0; k < std::llround(polls_hz * kSeconds); ++k) {
    const double t = static_cast<double>(k) / polls_hz;
    samples.time.push_back(core::Instant::from_ns(std::llround(1e9 * t)));
    samples.rate_rad_s.push_back(measured[static_cast<std::size_t>(50.0 * t + 1e-9)]);
  }
  return samples;
}

TEST(RepeatedSamples, OfAFastLoggerAreLeftOut) {
  for (const double polls_hz : {73.0, 100.0, 400.0}) {
    const RestSamples samples = polled(polls_hz, 50.0);
    const RestSamples rest = without_repeats(samples);
    // Some 0.6 % of the measurements equal the one before by chance.
    EXPECT_NEAR(static_cast<double>(rest.time.size()), 3'000.0, 50.0) << polls_hz;
    EXPECT_EQ(rest.repeated, samples.time.size() - rest.time.size());
    EXPECT_NEAR(static_cast<double>(rest.mean_period.ns()), 2e7, 4e5) << polls_hz;
  }
}

TEST(RepeatedSamples, OfAllAxesTogetherAreFew) {
  EXPECT_NEAR(static_cast<double>(without_repeats(polled(100.0, 20.0, 3)).time.size()), 3'000.0,
              3.0);
}

TEST(EqualNeighbours, OfASensorWithCoarseStepsAreNoRepeats) {
  for (const double sigma_in_steps : {0.0, 0.1, 0.3, 1.0, 3.0, 10.0}) {
    EXPECT_THAT(find_repeats(polled(50.0, sigma_in_steps)), IsEmpty()) << sigma_in_steps;
  }
}

TEST(EqualNeighbours, InCoarseStepsMayBeChanceAndStay) {
  EXPECT_THAT(find_repeats(polled(100.0, 1.0)), IsEmpty());
}

}  // namespace
}  // namespace zerorate::identify

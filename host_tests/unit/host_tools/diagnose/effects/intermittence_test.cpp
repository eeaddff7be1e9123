// Tones that are there in a part of the time, all the time, and resonances.

#include "host_tools/lib/diagnose/effects/intermittence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::diagnose {
namespace {

constexpr double kPeriod_s = 0.02;
constexpr std::int64_t kSize = 60'000;  // 20 min
constexpr double kTone_hz = 3.3;

/// White noise of unit size, and a sine of so much between two times.
std::vector<double> sine_between(double from_s, double to_s, double amplitude, std::uint64_t seed) {
  const random::RandomStream noise{seed};
  std::vector<double> values;
  for (std::int64_t k = 0; k < kSize; ++k) {
    const double time_s = kPeriod_s * static_cast<double>(k);
    const bool is_on = time_s >= from_s && time_s < to_s;
    const double tone = std::sin(2.0 * std::numbers::pi * kTone_hz * time_s);
    values.push_back(noise.normal(k) + (is_on ? amplitude * tone : 0.0));
  }
  return values;
}

TEST(ToneForAThirdOfTheTime, HasItsShareAndItsSize) {
  const std::vector<double> values = sine_between(400.0, 800.0, 0.3, 41);
  const auto found = find_intermittence(values, kPeriod_s, {.frequency_hz = kTone_hz});
  ASSERT_TRUE(found);
  EXPECT_LE(found->share_lo, 1.0 / 3.0);
  EXPECT_GE(found->share_hi, 1.0 / 3.0);
  EXPECT_NEAR(found->amplitude_rad_s, 0.3, 0.03);
  EXPECT_NEAR(found->from_s, 400.0, 50.0);
  EXPECT_NEAR(found->to_s, 800.0, 50.0);
}

// A fit may describe such a tone by a line of finite width.
TEST(ToneForAThirdOfTheTime, IsFoundByItsWidthToo) {
  const std::vector<double> values = sine_between(400.0, 800.0, 0.3, 42);
  const auto found =
      find_intermittence(values, kPeriod_s, {.frequency_hz = kTone_hz, .coherence_time_s = 20.0});
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->share, 1.0 / 3.0, 0.1);
}

TEST(SteadyTone, IsNotIntermittent) {
  for (const double amplitude : {0.05, 0.1, 0.3}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const std::vector<double> values = sine_between(0.0, 1200.0, amplitude, seed);
      EXPECT_FALSE(find_intermittence(values, kPeriod_s, {.frequency_hz = kTone_hz}))
          << amplitude << ", seed " << seed;
    }
  }
}

/// A mode of second order at the tone's frequency, whose phase wanders within 10 s.
TEST(Resonance, IsNotIntermittent) {
  constexpr double kCoherence_s = 10.0;
  const double kept = std::exp(-kPeriod_s / kCoherence_s);
  const double turn = 2.0 * std::numbers::pi * kTone_hz * kPeriod_s;
  const double driving = std::sqrt(1.0 - kept * kept);
  int told = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const random::RandomStream noise{seed};
    double x = 0.0;
    double y = 0.0;
    std::vector<double> values;
    for (std::int64_t k = 0; k < kSize; ++k) {
      const double next = kept * (std::cos(turn) * x - std::sin(turn) * y);
      y = kept * (std::sin(turn) * x + std::cos(turn) * y) + driving * noise.normal(3 * k);
      x = next + driving * noise.normal(3 * k + 1);
      values.push_back(0.5 * x + noise.normal(3 * k + 2));
    }
    told += find_intermittence(values, kPeriod_s,
                               {.frequency_hz = kTone_hz, .coherence_time_s = kCoherence_s})
                .has_value();
  }
  // With a chance of 0.001 each, two of 50 are seen in one test of 800.
  EXPECT_LE(told, 1);
}

TEST(NoTone, IsNotIntermittent) {
  const std::vector<double> values = sine_between(0.0, 0.0, 0.0, 43);
  EXPECT_FALSE(find_intermittence(values, kPeriod_s, {.frequency_hz = kTone_hz}));
}

}  // namespace
}  // namespace zerorate::diagnose

#include "host_tools/lib/simulate/effects/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_tools/lib/identify/allan_deviation.hpp"
#include "host_tools/lib/identify/density.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::simulate {
namespace {

constexpr double kBiasInstability = 3e-5;
constexpr double kSamplePeriod = 0.04;

std::vector<double> flicker(std::size_t samples, double order, std::uint64_t run) {
  const std::vector<Effect> effects{FlickerNoise{kBiasInstability, order}};
  return simulate(Signal(samples, kSamplePeriod), effects, random::RandomStream(20120416, run))
      .rate_rad_s;
}

// Welch's estimate has a relative variance of 1.06 / segments in a bin (Welch 1967), and Hann's
// window makes about 1.5 neighbouring bins one; 4.5 standard deviations of the mean over all bins.
TEST(FlickerNoise, HasTheDensityOfItsCoefficientAtEveryOrder) {
  constexpr std::size_t kSamples = 1U << 19U;
  constexpr std::size_t kSegment = 1024;
  constexpr std::size_t kFirstBin = 16;  // below, the window smears a steep spectrum
  constexpr double kSegments = 2.0 * kSamples / kSegment - 1.0;
  constexpr double kBins = (kSegment / 2.0 - kFirstBin) / 1.5;
  const double error = 4.5 * std::sqrt(1.06 / kSegments / kBins);
  for (const double order : {-0.3, 0.2, 0.5, 0.7, 0.9}) {
    const auto points =
        identify::welch_density(flicker(kSamples, order, 0), kSamplePeriod, kSegment);
    double ratio = 0.0;
    for (std::size_t j = kFirstBin; j < points.size(); ++j) {
      // Twice the two-sided B^2 / omega^(2d), with omega as the difference quotient sees it.
      const double omega =
          2.0 / kSamplePeriod * std::sin(std::numbers::pi * points[j].frequency_hz * kSamplePeriod);
      const double expected =
          2.0 * kBiasInstability * kBiasInstability * std::pow(omega, -2.0 * order);
      ratio += points[j].density / expected;
    }
    EXPECT_NEAR(ratio / static_cast<double>(points.size() - kFirstBin), 1.0, error) << order;
  }
}

// The mean of R Allan variances has a relative standard error of sqrt(2 / (edf R)).
TEST(FlickerNoise, HasItsAllanFloorAtTwoLnTwoOverPi) {
  constexpr std::size_t kSamples = 8192;
  constexpr std::size_t kRuns = 200;
  const std::vector<std::size_t> factors{32, 128};
  const double floor =
      2.0 * std::numbers::ln2 / std::numbers::pi * kBiasInstability * kBiasInstability;
  std::vector<double> sums(factors.size());
  for (std::size_t run = 0; run < kRuns; ++run) {
    const auto variances = identify::allan_variances(flicker(kSamples, 0.5, run), factors);
    for (std::size_t i = 0; i < factors.size(); ++i) sums[i] += variances[i];
  }
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const double edf = identify::equivalent_degrees_of_freedom(identify::PowerLaw::rate_flicker,
                                                               kSamples + 1, factors[i]);
    const double error = 4.5 * std::sqrt(2.0 / (edf * kRuns));
    EXPECT_NEAR(sums[i] / kRuns / floor, 1.0, error) << factors[i];
  }
}

}  // namespace
}  // namespace zerorate::simulate

/// @file
/// Tests of the residual of a hypothesis, with the error of the whole family controlled
/// (docs/design/diagnosis.md, section 6).
#pragma once

#include <string>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// A sound record fails the family with this probability.
inline constexpr double kFamilyError = 0.01;

/// Result of one test: the probability of any result as extreme, all places that were looked at
/// included.
struct Test {
  std::string words;  ///< fault that a failure shows, e.g. "the noise is skewed"
  double log_p = 0.0;
};

using Tests = std::vector<Test>;
/// Bands of frequency, and the strongest line.
[[nodiscard]] Tests test_spectrum(const StandardisedResidual& residual);
/// Variance in stretches of time, its periodicity and its clusters.
[[nodiscard]] Tests test_variance(const StandardisedResidual& residual);
/// Bands of frequency in stretches of time, and tones that move.
[[nodiscard]] Tests test_spectrum_over_time(const StandardisedResidual& residual);
/// Skewness and tails at several time scales, time asymmetry.
[[nodiscard]] Tests test_distribution(const StandardisedResidual& residual);
/// Values that are too frequent or missing among their neighbours.
[[nodiscard]] Tests test_levels(const StandardisedResidual& residual);
/// Dependence on temperature, its rate, its direction and its past.
[[nodiscard]] Tests test_temperature(const StandardisedResidual& residual);

[[nodiscard]] Adequacy examine_adequacy(const Hypothesis& hypothesis);

}  // namespace zerorate::diagnose

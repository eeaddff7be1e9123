/// @file
/// White noise of a sensor whose rates are rounded to coarse steps.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "host_tools/lib/identify/innovations_fit.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Range of a standard deviation, in steps.
struct SigmaRange {
  double lo = 0.0;
  double hi = 0.0;
};

/// Standard deviations of normal values that have, once they are rounded to whole numbers, such a
/// variance for some mean. From half a step on they agree with Sheppard's correction, a twelfth.
/// @param least, most  limits of the variance, above zero
[[nodiscard]] SigmaRange sigma_before_rounding(double least, double most);

/// Remark on an axis of which 5 % of the white variance are that of rounding: the sensor's own N,
/// were its samples not rounded. nullopt where the steps are finer.
/// @param walk  N of the rounded rates [rad/sqrt(s)]
[[nodiscard]] std::optional<std::string> remark_on_rounding(const RestSamples& samples,
                                                            std::size_t axis,
                                                            const IntervalEstimate& walk);

}  // namespace zerorate::identify

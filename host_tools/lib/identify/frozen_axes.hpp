/// @file
/// Axes of a recording at rest that no longer measure.
#pragma once

#include <array>
#include <vector>

#include "host_tools/lib/identify/rest_doubt.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// White variance of a sample of each axis by the differences of neighbours [rad2/s2].
[[nodiscard]] std::array<double, recording::kMaxAxes> variances_of_differences(
    const RestSamples& samples);

/// A doubt of each axis that repeats itself as noise does not, by the judgement of the firmware
/// (app::SampleWatch). Linear in the samples.
[[nodiscard]] std::vector<RestDoubt> doubts_of_frozen_axes(const RestSamples& samples);

}  // namespace zerorate::identify

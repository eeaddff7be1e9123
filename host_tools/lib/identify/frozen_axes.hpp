/// @file
/// Axes of a recording at rest that no longer measure.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// White variance of a sample of each axis by the differences of neighbours [rad2/s2].
[[nodiscard]] std::array<double, recording::kMaxAxes> variances_of_differences(
    const RestSamples& samples);

/// Sentence about the axis that repeats itself for the longest time, by the judgement of the
/// firmware (app::SampleWatch); nothing where all axes measure. Linear in the samples.
[[nodiscard]] std::optional<std::string> frozen_axis(const RestSamples& samples);

}  // namespace zerorate::identify

/// @file
/// Means that are too small for the zero-rate level of a gyro.
#pragma once

#include <cstddef>
#include <vector>

#include "host_tools/lib/identify/rest_doubt.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Whether the mean of an axis is less than half the standard deviation of the means of tenths of
/// the recording, which must not exceed 0.05 deg/s: a larger drift may cross zero. The zero-rate
/// level of a MEMS gyro is a hundred times as large; software that takes a bias out leaves such a
/// mean.
[[nodiscard]] bool is_mean_near_zero(const RestSamples& samples, std::size_t axis);

/// One doubt for all axes where all are like that, and one for each axis otherwise. None is
/// certain: white noise remains as it was.
[[nodiscard]] std::vector<RestDoubt> doubts_of_near_zero_means(const RestSamples& samples);

}  // namespace zerorate::identify

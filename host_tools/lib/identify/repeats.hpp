/// @file
/// Samples that a logger wrote more than once.
#pragma once

#include <cstddef>
#include <vector>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Smallest change between unequal neighbours among the first 100,000 samples, the resolution of
/// coarse rates [rad/s]; 0 where nothing changes.
[[nodiscard]] double smallest_step(const RestSamples& samples, std::size_t axis);

/// Samples, by index, that repeat the one before on all axes: a logger that polls faster than the
/// sensor measures. Each measurement would count once or twice, by chance, and the white noise of
/// the means would be too large. None where equal neighbours may be chance, as with coarse steps:
/// they must be 5 % of all and five times as frequent as equal samples further apart, and a change
/// must be four steps in the median. Ascending.
[[nodiscard]] std::vector<std::size_t> find_repeats(const RestSamples& samples);

/// The samples without their repeats, which are counted, and with the mean interval of those left.
[[nodiscard]] RestSamples without_repeats(const RestSamples& samples);

}  // namespace zerorate::identify

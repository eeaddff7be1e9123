/// @file
/// Angles in the columns of rates.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Sentence about an axis whose values are the sum of noise, and so angles. The mean square of the
/// change over 2 m samples is at least 1.8 times that over m, for all m from 1 to 512. White noise,
/// which every rate has, gives the same for both; a sum of white noise gives twice, a turn four
/// times as much. nullopt where no axis is like that, and with fewer than 10240 samples.
/// @param axes  indices of those that measure
[[nodiscard]] std::optional<std::string> angles_not_rates(const RestSamples& samples,
                                                          const std::vector<std::size_t>& axes);

}  // namespace zerorate::identify

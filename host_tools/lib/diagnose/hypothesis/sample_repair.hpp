/// @file
/// Repair of values that are lost or disturbed.
#pragma once

#include <cstdint>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/part.hpp"

namespace zerorate::diagnose {

/// Replaces marked values by what their neighbours let expect, with noise of the neighbours' size,
/// so that the spectrum of the whole stays what it was. Linear in the number of values.
/// @param values  one a sample [rad/s]
/// @param is_replaced  marks the values to replace
/// @param range  measuring range: a marked value at one of its ends is drawn from beyond that end
/// @param seed  of the noise; equal arguments give equal values
[[nodiscard]] std::vector<double> repair(const std::vector<double>& values,
                                         const std::vector<bool>& is_replaced, const Range& range,
                                         std::uint64_t seed);

}  // namespace zerorate::diagnose

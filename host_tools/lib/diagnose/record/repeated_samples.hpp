/// @file
/// Samples that repeat the one before, because no new one had arrived when they were read.
#pragma once

#include <cstddef>
#include <vector>

#include "host_tools/lib/diagnose/record/record.hpp"

namespace zerorate::diagnose {

/// The samples, by index and ascending, whose rate is exactly that of the sample before, where that
/// happens four times as often as chance makes it: equal neighbours by chance are as frequent as
/// neighbours that differ by the least difference, one way. Nothing where a single value makes up a
/// fifth of them: a range that ends, a dead band. O(n log n).
[[nodiscard]] std::vector<std::size_t> find_repeated_samples(const Record& record);

/// The record without these samples.
[[nodiscard]] Record without_samples(const Record& record,
                                     const std::vector<std::size_t>& left_out);

}  // namespace zerorate::diagnose

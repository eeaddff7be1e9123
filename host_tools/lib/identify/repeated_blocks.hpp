/// @file
/// Blocks of samples that a recording has more than once.
#pragma once

#include <optional>

#include "host_tools/lib/identify/rest_doubt.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// A doubt about rows that are, in order and bit by bit, those of an earlier place: a buffer that
/// was written again. So many rows in a row must be equal that chance makes one such pair in a
/// billion recordings, and four times as many, because neighbours are alike where steps are coarse;
/// none is found where half of all pairs of rows are equal. It is certain from 1 % of the rows on.
/// Looks at the first four million rows. Memory: two bytes a row. Linear in the rows.
[[nodiscard]] std::optional<RestDoubt> doubt_of_repeated_blocks(const RestSamples& samples);

}  // namespace zerorate::identify

/// @file
/// Rows of several sensors that take turns in one recording.
#pragma once

#include <optional>
#include <string>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Sentence about a recording in which every second, third or fourth sample has a level of its own.
/// Several sensors that write in turn make such a recording. The levels must differ by six of their
/// errors in most of at most 64 blocks of 240 samples. All changes together show two levels down to
/// the size of their white noise, also where rows are lost. nullopt where there are none.
[[nodiscard]] std::optional<std::string> sensors_in_turn(const RestSamples& samples);

}  // namespace zerorate::identify

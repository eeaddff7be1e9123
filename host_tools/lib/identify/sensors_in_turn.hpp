/// @file
/// Rows of several sensors that take turns in one recording.
#pragma once

#include <optional>
#include <string>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Sentence about a recording in which every second, third or fourth sample has a level of its own.
/// Several sensors that write in turn make such a recording. The levels must differ by six of their
/// errors in most of at most 64 blocks of 240 samples. Two levels are found by all changes together
/// as well, where rows are lost, down to the size of their white noise. nullopt where none are.
[[nodiscard]] std::optional<std::string> sensors_in_turn(const RestSamples& samples);

}  // namespace zerorate::identify

/// @file
/// Rows of several sensors that take turns in one recording.
#pragma once

#include <optional>
#include <string>

#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Sentence about a recording in which every second, third or fourth sample has a level of its own,
/// as where several sensors were written in turn: the levels differ by six of their errors in most
/// blocks of 240 samples, of which 64 are judged. nullopt where none does.
[[nodiscard]] std::optional<std::string> sensors_in_turn(const RestSamples& samples);

}  // namespace zerorate::identify

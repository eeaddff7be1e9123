/// @file
/// A replay as `replay` and `demo` run it: under a progress bar, into whatever is to be filled.
#pragma once

#include <optional>

#include "host_tools/lib/evaluate/corrected_writer.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/evaluate/replay_trace.hpp"

namespace zerorate::cli {

/// Where the samples and drives of a replay go; nullptr: nowhere.
struct ReplaySinks {
  evaluate::ReplayTrace* trace = nullptr;
  evaluate::CorrectedWriter* corrected = nullptr;
};

/// Replays to the end and finishes the sinks.
/// @param true_rate, truth as in evaluate::ReplayObserver
[[nodiscard]] evaluate::ReplayResult replay_watched(recording::Reader& reader,
                                                    const evaluate::ReplayOptions& options,
                                                    const ReplaySinks& sinks,
                                                    evaluate::TrueRate true_rate = {},
                                                    std::optional<truth::Truth> truth = {});

}  // namespace zerorate::cli

/// @file
/// View of a node for a terminal.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "host_tools/lib/live/tally.hpp"

namespace zerorate::live {

/// A message older than this is not shown as the present.
inline constexpr std::chrono::milliseconds kStale{1000};

/// Whether the newest message is current.
[[nodiscard]] inline bool is_present(const Tally& tally, std::chrono::milliseconds silence) {
  return tally.newest && silence <= kStale;
}

/// Names of what is set, "fine" where a calibrated node has nothing to report.
[[nodiscard]] std::string describe(const app::Health& health);

/// The node on a few lines of less than 80 characters: source, state, and for each axis the
/// corrected rate, the bias and the half-width of its 95 % interval; below, what was learnt.
/// @param silence  since the newest message
[[nodiscard]] std::string format_screen(const Tally& tally, std::string_view source,
                                        std::chrono::milliseconds silence);

/// The learnt model as a table of less than 80 columns, each figure with its standard deviation;
/// empty while nothing is learnt.
[[nodiscard]] std::string format_learnt(const Tally& tally);

/// The head of format_line()'s columns, with its line end.
[[nodiscard]] std::string_view line_header();

/// The newest message on one line; the tally must have one.
[[nodiscard]] std::string format_line(const Tally& tally);

}  // namespace zerorate::live

/// @file
/// State of a node and its history as the page in the browser shows them.
#pragma once

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>

#include "host_tools/lib/live/tally.hpp"

namespace zerorate::live {

/// State of this moment: `axes`, `vertical`, `learnt`, counts, and the names of what is `wrong`.
/// @param silence time since the newest message
[[nodiscard]] nlohmann::json now_json(const Tally& tally, const std::string& source,
                                      std::chrono::milliseconds silence);

/// Row of the history: time in Unix seconds, bias and half-width of each axis, 1 at rest and 0
/// otherwise; null in silence.
/// @param now now_json()
[[nodiscard]] nlohmann::json point_json(const nlohmann::json& now);

}  // namespace zerorate::live

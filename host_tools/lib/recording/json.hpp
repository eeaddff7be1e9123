/// @file
/// Members that every JSON of a recording has in common.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "host_tools/lib/recording/findings.hpp"

namespace zerorate::recording {

/// The number, or null where it is not finite: JSON has neither infinity nor nan.
[[nodiscard]] nlohmann::ordered_json number(double value);

/// One member a kind of finding that occurred: how many rows, and the line of the first.
[[nodiscard]] nlohmann::ordered_json to_json(const Findings& findings);

}  // namespace zerorate::recording

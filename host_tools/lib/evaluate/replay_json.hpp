/// @file
/// The result of a replay for other programs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host_tools/lib/evaluate/replay.hpp"

namespace zerorate::evaluate {

/// The axes that a user asked for: a recording's axes as x, y, z, or its only one as "rate".
[[nodiscard]] std::string axis_name(const ReplayResult& result, std::size_t axis);

/// Schema zerorate.replay/1, described in docs/reference/replay-json.md. Figures that do not exist,
/// such as the drift of no drive, are null.
/// @param axes indices of the axes to write
[[nodiscard]] std::string to_json(const ReplayResult& result, const std::vector<std::size_t>& axes);

}  // namespace zerorate::evaluate

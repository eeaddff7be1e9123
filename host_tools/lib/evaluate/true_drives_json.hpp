/// @file
/// Drives that were scored against a reference system, for other programs.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>

#include "host_tools/lib/evaluate/true_drives.hpp"

namespace zerorate::evaluate {

/// The key `true_drives` of zerorate.replay/1, described in docs/reference/replay-json.md.
[[nodiscard]] nlohmann::ordered_json true_drives_json(const TrueDrives& drives,
                                                      std::size_t axis_count);

}  // namespace zerorate::evaluate

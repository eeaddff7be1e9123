/// @file
/// Learnt noise model for other programs.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "host_tools/lib/evaluate/learnt_model.hpp"

namespace zerorate::evaluate {

/// Object `learnt` of an axis of the schema zerorate.replay/1, described in
/// docs/reference/replay-json.md.
[[nodiscard]] nlohmann::ordered_json learnt_json(const LearntModel& learnt);

}  // namespace zerorate::evaluate

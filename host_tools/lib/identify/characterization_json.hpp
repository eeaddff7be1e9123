/// @file
/// A characterization as JSON, schema zerorate.characterization/1 (docs/reference).
#pragma once

#include <string>
#include <string_view>

#include "host_tools/lib/identify/characterize.hpp"

namespace zerorate::identify {

/// How a fit came to its order: "given", "estimated", "prior" or "limit".
[[nodiscard]] std::string_view name(OrderSource source);

[[nodiscard]] std::string to_json(const Characterization& result);

}  // namespace zerorate::identify

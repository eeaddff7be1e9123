/// @file
/// A contest on drives as people and programs read it.
#pragma once

#include "host_tools/lib/experiments/drives/drives.hpp"
#include "host_tools/lib/experiments/presentation.hpp"

namespace zerorate::experiments {

/// Presents a contest; JSON of the schema zerorate.drives/1.
[[nodiscard]] Presentation present(const DriveContest& contest);

}  // namespace zerorate::experiments

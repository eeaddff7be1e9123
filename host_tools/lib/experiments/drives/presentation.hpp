/// @file
/// A contest on drives as people and programs read it.
#pragma once

#include "host_tools/lib/experiments/drives/drives.hpp"
#include "host_tools/lib/experiments/drives/learning.hpp"
#include "host_tools/lib/experiments/presentation.hpp"

namespace zerorate::experiments {

/// Presents a contest; JSON of the schema zerorate.drives/1.
[[nodiscard]] Presentation present(const DriveContest& contest);
/// Presents what learning is worth; JSON of the schema zerorate.learning/1.
[[nodiscard]] Presentation present(const LearningContest& contest);

}  // namespace zerorate::experiments

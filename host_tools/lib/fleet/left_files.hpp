/// @file
/// Temporary files that a merge left when it was killed.
#pragma once

#include <filesystem>

namespace zerorate::fleet {

/// Removes the temporary files beside a database (`NAME.PID.merging`, `NAME.PID.partial`) whose
/// process no longer runs. What cannot be removed stays.
void remove_of_dead_processes(const std::filesystem::path& out);

}  // namespace zerorate::fleet

/// @file
/// Where the real recordings lie, if they are there: $ZERORATE_DATA, or ../shared/data beside the
/// repository. Their licences differ, so they are never part of it.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace zerorate::testing {

/// The folder with the real recordings; nullopt where there is none.
/// @param repository  the root of the source tree
inline std::optional<std::filesystem::path> find_recordings(
    const std::filesystem::path& repository) {
  const char* const named = std::getenv("ZERORATE_DATA");
  const std::filesystem::path folder =
      named != nullptr ? std::filesystem::path{named} : repository / "../shared/data";
  if (!std::filesystem::is_directory(folder)) {
    return std::nullopt;
  }
  return folder;
}

}  // namespace zerorate::testing

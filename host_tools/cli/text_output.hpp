/// @file
/// Text results of a command: into a file, or to the standard output.
#pragma once

#include <filesystem>
#include <string>

namespace zerorate::cli {

/// Writes the text into the file; "-" is the standard output. Throws std::system_error.
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace zerorate::cli

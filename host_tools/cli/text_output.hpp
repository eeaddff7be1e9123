/// @file
/// Text results of a command: into a file, or to the standard output.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace zerorate::cli {

/// Writes the text into the file; "-" is the standard output. Throws std::system_error.
void write_text(const std::filesystem::path& path, const std::string& text);

/// The words of a paragraph in lines of at most 100 characters.
[[nodiscard]] std::string wrapped(std::string_view paragraph);

}  // namespace zerorate::cli

/// @file
/// Files of other programs, recognised by their headers.
#pragma once

#include <filesystem>
#include <string_view>

#include "host_tools/lib/recording/layout.hpp"

namespace zerorate::recording {

/// A user's word on a text file, completed by what the file shows.
struct CompletedLayout {
  Layout layout;
  std::string_view program;  ///< program that wrote the file; empty: not recognised
};

/// Where the user names no columns, a header of a known program gives columns and units, and text
/// before it is skipped. Where the user names columns, lines before the first with all of these
/// names are skipped. Programs whose headers for gyro and accelerometer are alike are recognised
/// by the name of the file, too.
/// @param ahead  beginning of the text  @param file  name of the file, with or without folders
[[nodiscard]] CompletedLayout complete_layout(const Layout& said, std::string_view ahead,
                                              const std::filesystem::path& file);

}  // namespace zerorate::recording

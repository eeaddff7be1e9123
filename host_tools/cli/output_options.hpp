/// @file
/// Where a command's results go besides the terminal.
#pragma once

#include <string>

#include "host_tools/lib/report/presentation.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): the library chose the name
class App;
}

namespace zerorate::cli {

/// Options as typed; empty where not given.
struct OutputOptions {
  std::string json;    ///< "-" is the standard output
  std::string report;  ///< HTML

  /// Whether the standard output is free for text.
  [[nodiscard]] bool prints_text() const { return json != "-"; }
};

/// Adds --json and --report.
void add_output_options(CLI::App& command, OutputOptions& outputs);

/// Gives an experiment's results to each output, and to the terminal.
/// @param provenance  the report's last line
void present(const report::Presentation& presentation, const std::string& provenance,
             const OutputOptions& outputs);

}  // namespace zerorate::cli

#include "host_tools/cli/output_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "host_tools/cli/terminal.hpp"

namespace zerorate::cli {

void add_output_options(CLI::App& command, OutputOptions& outputs) {
  command.add_option("--json", outputs.json, "write the figures as JSON; - for standard output");
  command.add_option("--report", outputs.report, "write a report with charts as HTML");
}

void present(const report::Presentation& presentation, const std::string& provenance,
             const OutputOptions& outputs) {
  if (!outputs.report.empty()) {
    report::to_report(presentation, provenance).write(outputs.report);
  }
  if (!outputs.json.empty()) write_text(outputs.json, presentation.json);
  if (outputs.prints_text()) fmt::print("{}", report::to_text(presentation));
}

}  // namespace zerorate::cli

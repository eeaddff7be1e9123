#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/recording/writer.hpp"

namespace zerorate::cli {
namespace {

struct ConvertOptions {
  InputFlags input;
  std::string output;
};

void copy_rows(recording::Reader& reader, recording::Writer& writer) {
  constexpr std::uint64_t kProgressRows = 4096;
  ProgressBar progress{"converting"};
  for (recording::Row row; reader.next(row);) {
    writer.write(row);
    if (reader.findings().rows() % kProgressRows == 0) progress.update(reader.fraction_read());
  }
  writer.finish();
}

ExitCode run_convert(const ConvertOptions& options) {
  recording::Reader reader{to_input(options.input)};
  recording::Writer writer{options.output, reader.columns()};
  copy_rows(reader, writer);
  const recording::Findings& findings = reader.findings();
  print_doubt_of_rows(findings);
  fmt::print("{}: {} samples every {:.6g} s\n", options.output, findings.rows(),
             static_cast<double>(findings.mean_interval_ns()) * 1e-9);
  print_findings(findings);
  for (const std::string& name : reader.ignored_columns()) {
    const std::string_view what = name.starts_with("column ") ? "" : "column ";
    fmt::print("  note: the {}{} is not needed\n", what, name);
  }
  return success;
}

}  // namespace

Command add_convert(CLI::App& app) {
  auto* command = app.add_subcommand(
      "convert", "Write a recording of another format in zerorate's own, odometer included");
  const auto options = std::make_shared<ConvertOptions>();
  add_input_options(*command, options->input);
  command->add_option("-o,--output", options->output, "CSV or CSV.gz file to write")->required();
  command->footer(
      "Every command that reads a recording takes the same options, so that nothing need be\n"
      "converted; the converted file is smaller and is read faster.\n"
      "Examples:\n"
      "  zerorate convert MH_01_easy -o euroc.csv.gz\n"
      "  zerorate convert log.csv --columns t=stamp,gx=wx,gy=wy,gz=wz --units time=ms,rate=radps "
      "-o run.csv.gz\n"
      "  zerorate convert imu.csv --odometer-file wheels.csv --speed-column vx_mps "
      "--odometer-units speed=mps --still-below 0.02 -o drive.csv.gz\n"
      "The format is described in docs/reference/recording-format.md.");
  return {command, [options] { return run_convert(*options); }};
}

}  // namespace zerorate::cli

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/output_options.hpp"
#include "host_tools/cli/reference_options.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/cli/watched_replay.hpp"
#include "host_tools/lib/evaluate/replay_json.hpp"
#include "host_tools/lib/evaluate/replay_report.hpp"

namespace zerorate::cli {
namespace {

struct ReplayCommandOptions {
  InputFlags input;
  ReplayFlags flags;
  TruthFlags truth;
  OutputOptions outputs;
  std::string out;
};

/// Names what the recording has and the model leaves out.
void print_unused(const recording::Columns& columns, const model::SensorModel& model) {
  const auto print = [](const char* quantity) {
    fmt::print(
        "  note: the recording has {}, and the model does not use it; 'zerorate compare' tells "
        "whether it would help\n",
        quantity);
  };
  if (columns.temperature && !model.temperature) print("a temperature");
  if (columns.acceleration && model.inputs.empty()) print("an acceleration");
}

/// Reason why the node measured no bias.
std::string lack_of_stops(bool has_odometer) {
  std::string reason = "the node measured no bias, as no stop was long enough";
  if (has_odometer) reason += fmt::format("; {}", identify::kCalmForAnOdometer);
  return reason;
}

ExitCode run_replay(const ReplayCommandOptions& options) {
  evaluate::ReplayOptions replay_options = to_replay_options(options.flags);
  replay_options.checks_rest = true;
  const recording::Input input = to_input(options.input);
  replay_options.accepted = identify::AcceptedDoubts{input.accepted};
  // A schedule means that the sensor was at rest: then nothing else is the truth.
  std::optional<truth::Truth> truth;
  if (!replay_options.schedule) truth = read_truth(input, options.truth);
  recording::Reader reader{input};
  const std::size_t axis_count = reader.columns().axis_count;
  const bool has_odometer = reader.columns().odometer && options.flags.still_from != "gyro";
  replay_options.references = reference_use(reader.columns(), options.truth, truth);
  const auto axes = shown_axes(options.flags, axis_count, truth);

  std::optional<evaluate::CorrectedWriter> corrected;
  if (!options.out.empty()) corrected.emplace(options.out, axis_count);
  evaluate::ReplayTrace trace{axes.front()};
  const bool traced = !options.outputs.report.empty();
  const evaluate::ReplayResult result = replay_watched(
      reader, replay_options,
      {.trace = traced ? &trace : nullptr, .corrected = corrected ? &*corrected : nullptr}, {},
      std::move(truth));
  if (traced) {
    evaluate::make_report(
        result, axes, trace, {}, replay_options.model,
        {.title = "Replay of " + options.input.recording,
         .lead = "The recording went through the node's firmware with the model " +
                 replay_options.model.name + ".",
         .provenance = "zerorate " ZERORATE_VERSION ", zerorate replay"})
        .write(options.outputs.report);
  }
  if (!options.outputs.json.empty()) {
    write_text(options.outputs.json,
               evaluate::to_json(result, scored_axes(options.flags, axis_count)));
  }
  if (options.outputs.prints_text()) {
    print_what_is_not_shown(options.flags, result, axes);
    print_result(result, axes);
    print_unused(reader.columns(), replay_options.model);
  }
  if (result.rows_corrected == 0) {
    fmt::print(
        stderr, "zerorate: no row has a corrected rate: {}\n",
        result.samples_frozen > 0 ? "the gyro did not measure" : lack_of_stops(has_odometer));
    return finding;
  }
  return success;
}

}  // namespace

Command add_replay(CLI::App& app) {
  auto* command = app.add_subcommand("replay", "Run a recording through the node's firmware");
  const auto options = std::make_shared<ReplayCommandOptions>();
  add_input_options(*command, options->input);
  add_replay_flags(*command, options->flags);
  add_truth_flags(*command, options->truth);
  add_learn_flag(*command, options->truth);
  add_output_options(*command, options->outputs);
  command->add_option("--out", options->out,
                      "write corrected rate, bias, sigma and turn since departure as CSV");
  command->footer(
      "Examples:\n"
      "  zerorate replay rest.csv.gz --schedule still=60,drive=300,seed=1\n"
      "  zerorate replay drive.csv --model lsm6dso --out corrected.csv --report drive.html\n"
      "  zerorate replay rest.csv --arw 0.004 --bias-instability 5 --schedule still=30,drive=120 "
      "--json -\n"
      "The format of recordings is described in docs/reference/recording-format.md.");
  return {command, [options] { return run_replay(*options); }};
}

}  // namespace zerorate::cli

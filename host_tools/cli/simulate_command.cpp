#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/watched_replay.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/simulate/scenario.hpp"

namespace zerorate::cli {
namespace {

struct SimulateOptions {
  std::string scenario;
  std::string output;
  std::uint64_t seed = 1;
  ReplayFlags flags;
};

ExitCode list_scenarios() {
  for (const simulate::Scenario& scenario : simulate::scenarios()) {
    fmt::print("{:<25}{}\n", scenario.name, scenario.summary);
  }
  return success;
}

void write(const simulate::ScenarioDrive& drive, const std::filesystem::path& path) {
  recording::Writer writer{path, drive.columns};
  for (const simulate::ScenarioRow& row : drive.rows) writer.write(row.row);
  writer.finish();
}

ExitCode run_simulate(const SimulateOptions& options) {
  if (options.scenario == "list") return list_scenarios();
  const simulate::Scenario& scenario = simulate::find_scenario(options.scenario);
  const std::string path =
      options.output.empty() ? std::string{scenario.name} + ".csv.gz" : options.output;
  evaluate::ReplayOptions replay_options = to_replay_options(options.flags);
  const simulate::ScenarioDrive drive = scenario.make(options.seed);
  write(drive, path);
  fmt::print("{}: {}\nThe recording: {}\n", scenario.name, scenario.summary, path);
  replay_options.has_data_ready = drive.has_data_ready;
  recording::Reader reader{path};
  const auto axes = chosen_axes(options.flags.axis, reader.columns().axis_count);
  print_result(replay_watched(reader, replay_options, {},
                              [&](std::uint64_t row) { return drive.rows[row].true_rate_rad_s; }),
               axes);
  return success;
}

}  // namespace

Command add_simulate(CLI::App& app) {
  auto* command = app.add_subcommand("simulate", "Simulate a drive that goes wrong and replay it");
  const auto options = std::make_shared<SimulateOptions>();
  command->add_option("--scenario", options->scenario, "its name; list: all names")->required();
  command->add_option("--seed", options->seed, "another seed, other noise")->capture_default_str();
  command->add_option("-o,--output", options->output,
                      "CSV or CSV.gz file to write; default NAME.csv.gz");
  options->flags.model = "lsm6dso";
  options->flags.through = "chip";
  add_replay_flags(*command, options->flags);
  command->footer(
      "Examples:\n"
      "  zerorate simulate --scenario list\n"
      "  zerorate simulate --scenario dead-encoder\n"
      "  zerorate simulate --scenario cold-start --model mine.toml -o cold.csv");
  return {command, [options] { return run_simulate(*options); }};
}

}  // namespace zerorate::cli

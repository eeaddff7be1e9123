#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/cli/watched_replay.hpp"
#include "host_tools/lib/evaluate/simulated_drive.hpp"
#include "host_tools/lib/fleet/simulated_fleet.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/simulate/scenario.hpp"

namespace zerorate::cli {
namespace {

/// Options of several kinds of simulation.
struct CommonOptions {
  std::string output;  ///< empty: named after what is simulated
  std::uint64_t seed = 1;
  double rate_hz = 20.0;  ///< a scenario has its own
};

struct SimulateOptions {
  CommonOptions common;
  std::string scenario;
  bool has_accelerometer = false;
  ReplayFlags flags;
  double rest_s = 0.0;  ///< 0: no recording at rest
  bool is_fleet = false;
  fleet::SimulatedFleetOptions fleet;  ///< seed and rate are the common ones
};

ExitCode list_scenarios() {
  for (const simulate::Scenario& scenario : simulate::scenarios()) {
    fmt::print("{:<24} {}\n", scenario.name, scenario.summary);
  }
  return success;
}

void write(const simulate::ScenarioDrive& drive, const std::filesystem::path& path) {
  recording::Writer writer{path, drive.columns};
  for (const simulate::ScenarioRow& row : drive.rows) writer.write(row.row);
  writer.finish();
}

ExitCode run_simulate_fleet(const SimulateOptions& options) {
  fleet::SimulatedFleetOptions fleet = options.fleet;
  fleet.seed = options.common.seed;
  fleet.rate_hz = options.common.rate_hz;
  const std::string folder = options.common.output.empty() ? "fleet" : options.common.output;
  ProgressBar progress{"simulating"};
  fleet::simulate_fleet(fleet, folder, [&](double share) { progress.update(share); });
  fmt::print("{}: {} recordings of {} sensors; fleet.csv lists them, truth.csv what is in them\n",
             folder, fleet.sensors * fleet.recordings, fleet.sensors);
  return success;
}

ExitCode run_simulate_rest(const SimulateOptions& options) {
  const evaluate::SimulatedRestParams params{.model = to_replay_options(options.flags).model,
                                             .duration_s = options.rest_s,
                                             .sample_rate_hz = options.common.rate_hz,
                                             .seed = options.common.seed};
  const std::string path = options.common.output.empty() ? "rest.csv.gz" : options.common.output;
  evaluate::write_simulated_rest(params, path);
  fmt::print("{}: {} at rest, {:g} s at {:g} Hz\n", path, params.model.name, params.duration_s,
             params.sample_rate_hz);
  return success;
}

ExitCode run_simulate(const SimulateOptions& options) {
  if (options.is_fleet) return run_simulate_fleet(options);
  if (options.rest_s > 0.0) return run_simulate_rest(options);
  if (options.scenario.empty()) {
    throw std::invalid_argument(
        "expected --scenario NAME, --scenario list, --rest SECONDS or --fleet");
  }
  if (options.scenario == "list") return list_scenarios();
  const simulate::Scenario& scenario = simulate::find_scenario(options.scenario);
  const std::string path = options.common.output.empty() ? std::string{scenario.name} + ".csv.gz"
                                                         : options.common.output;
  evaluate::ReplayOptions replay_options = to_replay_options(options.flags);
  simulate::ScenarioDrive drive = scenario.make(options.common.seed);
  if (options.has_accelerometer && !drive.rows.front().row.has_acceleration()) {
    throw std::invalid_argument(
        fmt::format("--accelerometer: the vehicle of {} has no forces; those of the scenarios of "
                    "motion have, such as car-park",
                    scenario.name));
  }
  drive.columns.acceleration = options.has_accelerometer;
  write(drive, path);
  fmt::print("{}: {}\nThe recording: {}\n", scenario.name, scenario.summary, path);
  replay_options.has_data_ready = drive.has_data_ready;
  recording::Reader reader{path};
  const auto axes = shown_axes(options.flags, reader.columns().axis_count, {});
  print_result(replay_watched(reader, replay_options, {},
                              [&](std::uint64_t row) { return drive.rows[row].true_rate_rad_s; }),
               axes);
  return success;
}

void add_fleet_options(CLI::App& command, SimulateOptions& options) {
  fleet::SimulatedFleetOptions& fleet = options.fleet;
  auto* is_fleet = command
                       .add_flag("--fleet", options.is_fleet,
                                 "a population of sensors at rest instead of a drive")
                       ->excludes("--rest");
  const auto add = [&](const char* name, auto& value, const char* text, const auto& check) {
    command.add_option(name, value, text)->needs(is_fleet)->check(check)->capture_default_str();
  };
  add("--sensors", fleet.sensors, "number of sensors", CLI::PositiveNumber);
  add("--recordings", fleet.recordings, "recordings of each sensor", CLI::PositiveNumber);
  add("--samples", fleet.samples, "samples of each recording", CLI::Range(1000, 10'000'000));
  add("--lots", fleet.lots, "lots of the sensors, one of them bad", CLI::PositiveNumber);
  add("--bad-lot-factor", fleet.bad_lot_factor, "factor on N and B of the bad lot's sensors",
      CLI::PositiveNumber);
  add("--hidden-share", fleet.hidden_share, "share of the sensors with a hidden effect on one axis",
      CLI::Range(0.0, 1.0));
  add("--nats", fleet.nats, "likelihood that the effect costs a model without it [nats]",
      CLI::PositiveNumber);
  add("--jobs", fleet.jobs, "threads; 0: as many as the machine has", CLI::Range(0, 256));
}

}  // namespace

Command add_simulate(CLI::App& app) {
  auto* command = app.add_subcommand(
      "simulate", "Simulate a drive that goes wrong and replay it, a gyro at rest, or a fleet");
  const auto options = std::make_shared<SimulateOptions>();
  auto* scenario =
      command->add_option("--scenario", options->scenario, "its name; list: all names");
  command
      ->add_flag("--accelerometer", options->has_accelerometer,
                 "the recording of a scenario of motion has accelerations, and the node takes them")
      ->needs(scenario);
  command
      ->add_option("--rest", options->rest_s,
                   "seconds of a gyro at rest whose noise is that of --model, instead of a drive")
      ->check(CLI::Range(10.0, 1e6))
      ->excludes(scenario);
  command
      ->add_option("--rate-hz", options->common.rate_hz,
                   "samples a second of --rest and --fleet [Hz]")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  command->add_option("--seed", options->common.seed, "another seed, other noise")
      ->capture_default_str();
  command->add_option(
      "-o,--output", options->common.output,
      "CSV or CSV.gz file to write, default NAME.csv.gz or rest.csv.gz; folder of a fleet, "
      "default fleet");
  add_fleet_options(*command, *options);
  options->flags.model = "lsm6dso";
  options->flags.through = "chip";
  add_replay_flags(*command, options->flags);
  command->footer(
      "Examples:\n"
      "  zerorate simulate --scenario list\n"
      "  zerorate simulate --scenario dead-encoder\n"
      "  zerorate simulate --scenario car-park --accelerometer\n"
      "  zerorate simulate --scenario cold-start --model mine.toml -o cold.csv\n"
      "  zerorate simulate --rest 7200 --rate-hz 20 --model adis16405 -o rest.csv.gz\n"
      "  zerorate simulate --fleet --sensors 100 --seed 7 -o fleet");
  return {command, [options] { return run_simulate(*options); }};
}

}  // namespace zerorate::cli

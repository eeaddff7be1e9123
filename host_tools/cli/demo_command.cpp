#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/progress_bar.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/text_output.hpp"
#include "host_tools/cli/watched_replay.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/presentation/presentation.hpp"
#include "host_tools/lib/evaluate/replay_json.hpp"
#include "host_tools/lib/evaluate/replay_report.hpp"
#include "host_tools/lib/evaluate/simulated_drive.hpp"

namespace zerorate::cli {
namespace {

constexpr std::size_t kYaw = 2;

struct DemoOptions {
  InputFlags input;  ///< without a recording: a simulated drive
  ReplayFlags flags;
  std::string directory = "zerorate-demo";
  double hours = 2.0;
  std::uint64_t seed = 1;
};

/// A replay that leaves its results in the demo's directory.
void replay_and_report(const DemoOptions& options, const recording::Input& recording,
                       const evaluate::ReplayOptions& replay_options, evaluate::TrueRate true_rate,
                       const evaluate::RestRecord& rest, const evaluate::ReplayReportText& text) {
  const std::filesystem::path directory = options.directory;
  recording::Reader reader{recording};
  const auto axes = chosen_axes(options.flags.axis, reader.columns().axis_count);
  evaluate::ReplayTrace trace{axes.back()};
  const evaluate::ReplayResult result =
      replay_watched(reader, replay_options, {.trace = &trace}, std::move(true_rate));
  write_text(directory / "replay.json", evaluate::to_json(result, axes));
  const auto report = directory / "report.html";
  evaluate::make_report(result, axes, trace, rest, replay_options.model, text).write(report);
  print_result(result, axes);
  fmt::print("\n{}\n\nThe report with charts: {}\nThe figures as JSON:   {}\n",
             evaluate::summary(result, axes.back()), std::filesystem::absolute(report).string(),
             std::filesystem::absolute(directory / "replay.json").string());
}

/// The drive once more, with the model that the diagnosis has extended.
void replay_extended(const DemoOptions& options, evaluate::ReplayOptions replay_options,
                     const evaluate::SimulatedDrive& drive, const diagnose::Diagnosis& diagnosis) {
  if (diagnosis.causes.empty() || !diagnosis.gain.is_measured()) return;
  replay_options.model = diagnosis.extended_model;
  recording::Reader reader{std::filesystem::path(options.directory) / "drive.csv.gz"};
  const evaluate::ReplayResult result = replay_watched(
      reader, replay_options, {}, [&](std::uint64_t row) { return drive.true_rate_rad_s(row); });
  fmt::print("The drive once more, with the extended model. {}\n\n",
             evaluate::summary(result, kYaw));
}

/// Diagnoses what the sensor of the drive gave while the vehicle was parked.
diagnose::Diagnosis diagnose_parked(const DemoOptions& options,
                                    const evaluate::SimulatedDrive& drive) {
  constexpr double kParkedS = 1800.0;
  const std::filesystem::path directory = options.directory;
  const auto recording = directory / "parked.csv.gz";
  drive.write_parked(recording, kParkedS);
  fmt::print(
      "\nThe gyro has an effect that its model does not know. Diagnosing half an hour "
      "parked ...\n\n");
  recording::Reader reader{recording};
  const auto record = diagnose::record_of(identify::read_rest_samples(reader), 0);
  diagnose::DiagnoseOptions diagnose_options{.recording = "parked.csv.gz"};
  std::vector<diagnose::Diagnosis> diagnosis;
  {
    ProgressBar progress{"diagnosing"};
    diagnose_options.on_progress = [&](double share) { progress.update(share); };
    diagnosis.push_back(diagnose::diagnose(record, diagnose_options));
  }
  const auto report = directory / "diagnosis.html";
  diagnose::make_report(diagnosis,
                        {.title = "zerorate: what the model does not know",
                         .recording = "parked.csv.gz",
                         .provenance = fmt::format("zerorate {}, zerorate demo --seed {}",
                                                   ZERORATE_VERSION, options.seed)})
      .write(report);
  fmt::print("{}\n\nThe report of the diagnosis: {}\n\n", diagnose::in_words(diagnosis.front()),
             std::filesystem::absolute(report).string());
  return std::move(diagnosis.front());
}

ExitCode run_simulated(DemoOptions& options) {
  const auto recording = std::filesystem::path(options.directory) / "drive.csv.gz";
  evaluate::ReplayOptions replay_options = to_replay_options(options.flags);
  fmt::print("Simulating a drive of {:g} h with {} ...\n", options.hours,
             replay_options.model.name);
  const auto drive = evaluate::simulate_drive(
      {.model = replay_options.model,
       .duration_s = options.hours * 3600.0,
       .seed = options.seed,
       .hidden = {evaluate::draw_hidden_effect(
           replay_options.model, random::RandomStream(options.seed).substream("hidden"))}});
  drive.write(recording);
  fmt::print("Replaying {} through the simulated chip, its driver and the node ...\n\n",
             std::filesystem::absolute(recording).string());
  replay_and_report(
      options, recording, replay_options,
      [&](std::uint64_t row) { return drive.true_rate_rad_s(row); },
      {.rate_rad_s = drive.rest_rate_rad_s(kYaw),
       .sample_period_s = drive.sample_period_s(),
       .caption = "The simulated sensor as it would read if the vehicle had not moved, against the "
                  "model that the node runs."},
      {.title = "zerorate: a simulated drive",
       .lead =
           fmt::format("A vehicle drove and stopped, {:g} h in all. Its gyro ({}) was read through "
                       "the simulated chip and the real driver; at each stop the node measured "
                       "the bias, and predicted it while the vehicle drove.",
                       options.hours, replay_options.model.name),
       .provenance = fmt::format("zerorate {}, zerorate demo --hours {:g} --seed {}",
                                 ZERORATE_VERSION, options.hours, options.seed)});
  replay_extended(options, replay_options, drive, diagnose_parked(options, drive));
  return success;
}

ExitCode run_recorded(const DemoOptions& options) {
  const evaluate::ReplayOptions replay_options = to_replay_options(options.flags);
  const recording::Input input = to_input(options.input);
  const std::string& recording = options.input.recording;
  const bool at_rest = replay_options.schedule.has_value();
  evaluate::RestRecording rest;
  if (at_rest) rest = evaluate::read_at_rest(input, chosen_axes(options.flags.axis, 3).back());
  replay_and_report(
      options, input, replay_options, {},
      {.rate_rad_s = rest.rate_rad_s,
       .sample_period_s = rest.sample_period_s,
       .caption = "The recording against the model that the node runs. Where they part, "
                  "the model lacks something."},
      {.title = "zerorate: " + input.path.filename().string(),
       .lead = fmt::format("The recording went through the node's firmware with the "
                           "model of {}.",
                           replay_options.model.name),
       .provenance = "zerorate " ZERORATE_VERSION ", zerorate demo " + recording});
  return success;
}

ExitCode run_demo(DemoOptions& options) {
  std::filesystem::create_directories(options.directory);
  return options.input.recording.empty() ? run_simulated(options) : run_recorded(options);
}

}  // namespace

Command add_demo(CLI::App& app) {
  auto* command = app.add_subcommand(
      "demo", "Simulate a drive, or take a recording, and show what the node makes of it");
  const auto options = std::make_shared<DemoOptions>();
  add_input_options(*command, options->input)
      ->required(false)
      ->description("a recording as of replay; none: a simulated drive");
  add_replay_flags(*command, options->flags);
  command->add_option("--directory", options->directory, "where report and data go")
      ->capture_default_str();
  command->add_option("--hours", options->hours, "length of the simulated drive [h]")
      ->check(CLI::Range(0.1, 100.0))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "another seed, another drive")
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  zerorate demo\n"
      "  zerorate demo rest.csv.gz --schedule still=30,drive=120,seed=1");
  return {command, [command, options] {
            // The simulated drive goes through the chip whose model it uses.
            if (options->input.recording.empty()) {
              if (command->count("--model") == 0) options->flags.model = "lsm6dso";
              if (command->count("--through") == 0) options->flags.through = "chip";
            }
            return run_demo(*options);
          }};
}

}  // namespace zerorate::cli

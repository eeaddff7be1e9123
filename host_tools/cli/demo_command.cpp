#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/cli/watched_replay.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/presentation/presentation.hpp"
#include "host_tools/lib/evaluate/replay_json.hpp"
#include "host_tools/lib/evaluate/replay_report.hpp"
#include "host_tools/lib/evaluate/simulated_drive.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::cli {
namespace {

constexpr std::size_t kYaw = 2;

struct DemoOptions {
  InputFlags input;  ///< without a recording: a simulated drive
  ReplayFlags flags;
  std::string directory = "zerorate-demo";
  double hours = 2.0;
  std::uint64_t seed = 3;  ///< seed of seven with the median ratio to the calibration mean
};

/// A replay that leaves its results in the demo's directory.
void replay_and_report(const DemoOptions& options, const recording::Input& recording,
                       const evaluate::ReplayOptions& replay_options, evaluate::TrueRate true_rate,
                       const evaluate::RestRecord& rest, const evaluate::ReplayReportText& text) {
  const std::filesystem::path directory = options.directory;
  recording::Reader reader{recording};
  const std::size_t axis_count = reader.columns().axis_count;
  const auto axes = shown_axes(options.flags, axis_count, {});
  evaluate::ReplayTrace trace{axes.front()};
  const evaluate::ReplayResult result =
      replay_watched(reader, replay_options, {.trace = &trace}, std::move(true_rate));
  write_text(directory / "replay.json",
             evaluate::to_json(result, scored_axes(options.flags, axis_count)));
  const auto report = directory / "report.html";
  evaluate::make_report(result, axes, trace, rest, replay_options.model, text).write(report);
  print_what_is_not_shown(options.flags, result, axes);
  print_result(result, axes);
  fmt::print("\n{}\n\nThe report with charts: {}\nThe figures as JSON:   {}\n",
             evaluate::summary(result, axes.front()), std::filesystem::absolute(report).string(),
             std::filesystem::absolute(directory / "replay.json").string());
}

/// A drive of the demo, simulated and written into its directory.
struct DemoDrive {
  std::filesystem::path recording;
  evaluate::SimulatedDrive drive;

  DemoDrive(const DemoOptions& options, const model::SensorModel& model, const char* file,
            std::uint64_t seed, std::vector<simulate::Effect> hidden)
      : recording(std::filesystem::path(options.directory) / file),
        drive(evaluate::simulate_drive({.model = model,
                                        .duration_s = options.hours * 3600.0,
                                        .seed = seed,
                                        .hidden = std::move(hidden)})) {
    drive.write(recording);
  }

  [[nodiscard]] evaluate::TrueRate true_rate() const {
    return [this](std::uint64_t row) { return drive.true_rate_rad_s(row); };
  }
};

/// A gyro that behaves like its model.
void show_plain_drive(const DemoOptions& options, const evaluate::ReplayOptions& replay_options) {
  fmt::print("1. A drive of {:g} h. The gyro behaves like its model ({}).\n", options.hours,
             replay_options.model.name);
  const DemoDrive demo{options, replay_options.model, "drive.csv.gz", options.seed, {}};
  fmt::print("   {} goes through the simulated chip, its driver and the node.\n\n",
             std::filesystem::absolute(demo.recording).string());
  replay_and_report(
      options, demo.recording, replay_options, demo.true_rate(),
      {.rate_rad_s = demo.drive.rest_rate_rad_s(kYaw),
       .sample_period_s = demo.drive.sample_period_s(),
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
}

/// Scores of the yaw axis.
evaluate::DriveScores replay_with(const DemoDrive& demo, evaluate::ReplayOptions options,
                                  const model::SensorModel& model) {
  options.model = model;
  recording::Reader reader{demo.recording};
  return replay_watched(reader, options, {}, demo.true_rate()).scores[kYaw].front();
}

/// Diagnoses what the sensor of the drive gave while the vehicle was parked.
diagnose::Diagnosis diagnose_parked(const DemoOptions& options, const DemoDrive& demo) {
  constexpr double kParkedS = 1800.0;
  const std::filesystem::path directory = options.directory;
  const auto recording = directory / "parked.csv.gz";
  demo.drive.write_parked(recording, kParkedS);
  recording::Reader reader{recording};
  const auto record = diagnose::record_of(identify::read_rest_samples(reader), 0);
  diagnose::DiagnoseOptions diagnose_options{.recording = "parked.csv.gz"};
  ProgressBar progress{"diagnosing"};
  diagnose_options.on_progress = [&](double share) { progress.update(share); };
  std::vector<diagnose::Diagnosis> diagnosis{diagnose::diagnose(record, diagnose_options)};
  diagnose::make_report(diagnosis,
                        {.title = "zerorate: what the model does not know",
                         .recording = "parked.csv.gz",
                         .provenance = fmt::format("zerorate {}, zerorate demo --seed {}",
                                                   ZERORATE_VERSION, options.seed)})
      .write(directory / "diagnosis.html");
  return std::move(diagnosis.front());
}

std::string in_words(const evaluate::DriveScores& scores) {
  return fmt::format("{:.2f} deg rms a drive, {:.0f} % of the drives inside the 95 % interval",
                     scores.heading_drift_rms_rad() * units::kDegPerRad,
                     100.0 * scores.coverage95());
}

/// A gyro that hides an effect, and what finding it is worth.
void show_hidden_effect(const DemoOptions& options, const evaluate::ReplayOptions& replay_options) {
  fmt::print("\n2. Another drive. Its gyro hides an effect that the model does not know.\n");
  const random::RandomStream stream(options.seed);
  const std::uint64_t seed = stream.substream("second drive").bits(0);
  const DemoDrive demo{options,
                       replay_options.model,
                       "drive-2.csv.gz",
                       seed,
                       {evaluate::draw_hidden_tone(replay_options.model, stream)}};
  const diagnose::Diagnosis diagnosis = diagnose_parked(options, demo);
  const auto before = replay_with(demo, replay_options, replay_options.model);
  const auto after = replay_with(demo, replay_options, diagnosis.extended_model);
  fmt::print("   Model as it was:  heading drift {}.\n", in_words(before));
  fmt::print("   Diagnosis of half an hour parked: {}, {}.\n",
             diagnose::verdict_in_words(diagnosis), diagnose::causes_in_words(diagnosis));
  fmt::print("   Model extended:   heading drift {}.\n\n", in_words(after));
  fmt::print("The report of the diagnosis: {}\n",
             std::filesystem::absolute(std::filesystem::path(options.directory) / "diagnosis.html")
                 .string());
}

ExitCode run_simulated(const DemoOptions& options) {
  evaluate::ReplayOptions replay_options = to_replay_options(options.flags);
  replay_options.is_model_chosen = true;  // the simulated gyro is as this model
  show_plain_drive(options, replay_options);
  show_hidden_effect(options, replay_options);
  return success;
}

ExitCode run_recorded(const DemoOptions& options) {
  const evaluate::ReplayOptions replay_options = to_replay_options(options.flags);
  const recording::Input input = to_input(options.input);
  const std::string& recording = options.input.recording;
  const bool at_rest = replay_options.schedule.has_value();
  evaluate::RestRecording rest;
  if (at_rest) {
    const std::size_t axis_count = recording::Reader{input}.columns().axis_count;
    rest = evaluate::read_at_rest(input, shown_axes(options.flags, axis_count, {}).front());
  }
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

ExitCode run_demo(const DemoOptions& options) {
  std::filesystem::create_directories(options.directory);
  return options.input.recording.empty() ? run_simulated(options) : run_recorded(options);
}

}  // namespace

Command add_demo(CLI::App& app) {
  auto* command = app.add_subcommand(
      "demo", "Simulate two drives, or take a recording, and show what the node makes of it");
  const auto options = std::make_shared<DemoOptions>();
  add_input_options(*command, options->input)
      ->required(false)
      ->description("a recording as of replay; none: a simulated drive");
  add_replay_flags(*command, options->flags);
  command->get_option("--model")->default_str("lsm6dso (with RECORDING adis16405)");
  command->get_option("--through")->default_str("chip (with RECORDING source)");
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

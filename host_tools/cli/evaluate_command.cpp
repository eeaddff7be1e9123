#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/output_options.hpp"
#include "host_tools/cli/progress_bar.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/lib/experiments/drives/presentation.hpp"

namespace zerorate::cli {
namespace {

struct EvaluateOptions {
  std::vector<std::string> recordings;
  std::vector<std::string> schedules{"15/60", "30/120", "60/300", "20/300", "120/600"};
  std::string fit_on = "other";
  std::string fit_by = "characterization";
  experiments::DriveContestOptions contest;
  OutputOptions outputs;
};

/// "15/60": mean lengths of stop and drive.
evaluate::ScheduleParams schedule_of(const std::string& text) {
  const auto slash = text.find('/');
  if (slash == std::string::npos) {
    throw std::invalid_argument(
        fmt::format("--schedules: '{}', expected STOP/DRIVE in seconds, as in 30/120", text));
  }
  return evaluate::parse_schedule("still=" + text.substr(0, slash) +
                                  ",drive=" + text.substr(slash + 1));
}

ExitCode run_evaluate(EvaluateOptions options) {
  for (const std::string& text : options.schedules) {
    options.contest.schedules.push_back(schedule_of(text));
  }
  options.contest.fit_on =
      options.fit_on == "other" ? experiments::FitOn::other : experiments::FitOn::itself;
  options.contest.fit_by = options.fit_by == "diagnosis" ? experiments::FitBy::diagnosis
                                                         : experiments::FitBy::characterization;
  const auto contest = [&] {
    ProgressBar bar{"drives"};
    return experiments::run_drive_contest({options.recordings.begin(), options.recordings.end()},
                                          options.contest,
                                          [&bar](double share) { bar.update(share); });
  }();
  present(experiments::present(contest), "zerorate " ZERORATE_VERSION ", zerorate evaluate drives",
          options.outputs);
  return success;
}

}  // namespace

Command add_evaluate(CLI::App& app) {
  auto* command = app.add_subcommand(
      "evaluate", "Compare bias predictors on drives cut out of recordings at rest");
  const auto options = std::make_shared<EvaluateOptions>();
  auto* drives = command->add_subcommand(
      "drives", "Heading drift and interval of each predictor, by lengths of stop and drive");
  command->require_subcommand(1);
  drives->add_option("RECORDING", options->recordings, "CSV or CSV.gz files, made at rest")
      ->required()
      ->check(CLI::ExistingFile);
  drives->add_option("--schedules", options->schedules, "mean lengths STOP/DRIVE [s]")
      ->delimiter(',')
      ->capture_default_str();
  drives->add_option("--seeds", options->contest.seeds, "random schedules of each kind")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  drives->add_option("--seed", options->contest.first_seed, "the first of them")
      ->capture_default_str();
  drives
      ->add_option("--fit-on", options->fit_on,
                   "where a recording's parameters come from: other (the other recordings) or "
                   "itself (hindsight)")
      ->check(CLI::IsMember({"other", "itself"}))
      ->capture_default_str();
  drives
      ->add_option("--fit-by", options->fit_by,
                   "what makes the models: characterization (order fitted against d = 1/2) or "
                   "diagnosis (what `zerorate diagnose` finds against its base)")
      ->check(CLI::IsMember({"characterization", "diagnosis"}))
      ->capture_default_str();
  drives
      ->add_option("--filter-rate", options->contest.filter_rate_hz,
                   "filter ticks per second [Hz]; 2, or the sensor's rate if that is lower")
      ->check(CLI::PositiveNumber);
  drives
      ->add_option("--threads", options->contest.threads,
                   "0: as many as there are; the figures do not depend on it")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  add_output_options(*drives, options->outputs);
  drives->footer(
      "Examples:\n"
      "  zerorate evaluate drives run1.csv.gz run2.csv.gz run3.csv.gz\n"
      "  zerorate evaluate drives run*.csv.gz --schedules 30/120,60/300 --seeds 20 --json -\n"
      "  zerorate evaluate drives rest.csv --fit-on itself --report drives.html");
  return {command, [options] { return run_evaluate(*options); }};
}

}  // namespace zerorate::cli

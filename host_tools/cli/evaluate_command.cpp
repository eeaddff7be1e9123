#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/output_options.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/contest/learning.hpp"
#include "host_tools/lib/contest/presentation.hpp"
#include "host_tools/lib/evaluate/model_table.hpp"

namespace zerorate::cli {
namespace {

struct EvaluateOptions {
  std::vector<std::string> recordings;
  InputFlags format;
  std::vector<std::string> schedules{"15/60", "30/120", "60/300", "20/300", "120/600"};
  std::string fit_on = "other";
  std::string fit_by = "characterization";
  std::string learn;
  std::vector<double> white_factors{1.0};
  std::vector<double> flicker_factors{1.0};
  contest::DriveContestOptions contest;
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

/// Data sheets that are wrong by the factors, one a pair; a single factor goes with all others.
std::vector<contest::DataSheetError> data_sheet_errors(const EvaluateOptions& options) {
  const auto& white = options.white_factors;
  const auto& flicker = options.flicker_factors;
  const std::size_t cases = std::max(white.size(), flicker.size());
  if (std::min(white.size(), flicker.size()) > 1 && white.size() != flicker.size()) {
    throw std::invalid_argument(fmt::format(
        "--white-factor names {} factors and --flicker-factor {}: name as many, or one of them",
        white.size(), flicker.size()));
  }
  std::vector<contest::DataSheetError> errors;
  for (std::size_t i = 0; i < cases; ++i) {
    errors.push_back({.white = white[white.size() == 1 ? 0 : i],
                      .flicker = flicker[flicker.size() == 1 ? 0 : i]});
  }
  return errors;
}

/// Runs a contest under a progress bar.
template <class Contest, class Options>
Contest run_watched(Contest (*contest)(const std::vector<std::filesystem::path>&, const Options&,
                                       const parallel::Progress&),
                    const EvaluateOptions& options, const Options& contest_options) {
  ProgressBar bar{"drives"};
  return contest({options.recordings.begin(), options.recordings.end()}, contest_options,
                 [&bar](double share) { bar.update(share); });
}

/// All models of the catalogue, but for those that no sensor has.
ExitCode run_models(const evaluate::StopAndGo& traffic, const OutputOptions& outputs) {
  std::vector<evaluate::ModelFigures> models;
  {
    ProgressBar bar{"models"};
    for (const auto& entry : model::catalogue()) {
      if (entry.name == "paper") continue;
      bar.update(static_cast<double>(models.size()) /
                 static_cast<double>(model::catalogue().size()));
      models.push_back(
          evaluate::figures_of(std::string{entry.name}, model::find_model(entry.name), traffic));
    }
  }
  present(evaluate::present(models, traffic),
          "zerorate " ZERORATE_VERSION ", zerorate evaluate models", outputs);
  return success;
}

ExitCode run_evaluate(EvaluateOptions options) {
  for (const std::string& text : options.schedules) {
    options.contest.schedules.push_back(schedule_of(text));
  }
  options.contest.format = to_input(options.format);
  options.contest.fit_on =
      options.fit_on == "other" ? contest::FitOn::other : contest::FitOn::itself;
  options.contest.fit_by =
      options.fit_by == "diagnosis" ? contest::FitBy::diagnosis : contest::FitBy::characterization;
  const auto presentation =
      options.learn.empty()
          ? contest::present(run_watched(contest::run_drive_contest, options, options.contest))
          : contest::present(
                run_watched(contest::run_learning_contest, options,
                            contest::LearningOptions{.model = model::load_model(options.learn),
                                                     .cases = data_sheet_errors(options),
                                                     .drives = options.contest}));
  present(presentation, "zerorate " ZERORATE_VERSION ", zerorate evaluate drives", options.outputs);
  return success;
}

CLI::App* add_models(CLI::App& evaluate, evaluate::StopAndGo& traffic, OutputOptions& outputs) {
  auto* models = evaluate.add_subcommand(
      "models", "Noise, simulated heading drift and tolerances of all models of the catalogue");
  models->add_option("--stop", traffic.stop_s, "length of each stop [s]")
      ->check(CLI::Range(5.0, 3600.0))
      ->capture_default_str();
  models->add_option("--drive", traffic.drive_s, "length of each drive [s]")
      ->check(CLI::Range(5.0, 7200.0))
      ->capture_default_str();
  models->add_option("--drives", traffic.drives, "simulated drives of each axis")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  add_output_options(*models, outputs);
  models->footer(
      "Examples:\n"
      "  zerorate evaluate models\n"
      "  zerorate evaluate models --stop 60 --drive 600 --json -\n"
      "What the columns mean, and the table of today: docs/chips/which-chip.md.");
  return models;
}

}  // namespace

Command add_evaluate(CLI::App& app) {
  auto* command = app.add_subcommand(
      "evaluate", "Compare bias predictors on drives cut out of recordings at rest, and models");
  const auto traffic = std::make_shared<evaluate::StopAndGo>();
  const auto models_outputs = std::make_shared<OutputOptions>();
  auto* models = add_models(*command, *traffic, *models_outputs);
  const auto options = std::make_shared<EvaluateOptions>();
  auto* drives = command->add_subcommand(
      "drives", "Heading drift and interval of each predictor, by lengths of stop and drive");
  command->require_subcommand(1);
  drives->add_option("RECORDING", options->recordings, "CSV or CSV.gz files, made at rest")
      ->required()
      ->check(CLI::ExistingFile);
  add_axis_option(*drives, options->contest.axis);
  add_format_options(*drives, options->format);
  drives->add_option("--schedules", options->schedules, "mean lengths STOP/DRIVE [s]")
      ->delimiter(',')
      ->capture_default_str();
  drives->add_option("--seeds", options->contest.seeds, "random schedules of each kind")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  drives->add_option("--seed", options->contest.first_seed, "the first of them")
      ->capture_default_str();
  auto* fit_on =
      drives
          ->add_option("--fit-on", options->fit_on,
                       "where a recording's parameters come from: other (the other recordings) or "
                       "itself (hindsight)")
          ->check(CLI::IsMember({"other", "itself"}))
          ->capture_default_str();
  auto* fit_by =
      drives
          ->add_option("--fit-by", options->fit_by,
                       "source of the models: characterization (order fitted against d = 1/2) or "
                       "diagnosis (what `zerorate diagnose` finds against its base)")
          ->check(CLI::IsMember({"characterization", "diagnosis"}))
          ->capture_default_str();
  auto* learn =
      drives
          ->add_option("--learn", options->learn,
                       "a node that learns from nothing, with this model (a TOML file or a name "
                       "from 'zerorate model list') as its data sheet, against filters that were "
                       "fitted")
          ->excludes(fit_on)
          ->excludes(fit_by);
  drives
      ->add_option("--white-factor", options->white_factors,
                   "with --learn: the data sheet's N over the model's; several: a case each")
      ->delimiter(',')
      ->check(CLI::Range(1e-3, 1e3))
      ->needs(learn)
      ->capture_default_str();
  drives
      ->add_option("--flicker-factor", options->flicker_factors,
                   "with --learn: the data sheet's B over the model's, as many or one for all")
      ->delimiter(',')
      ->check(CLI::Range(1e-3, 1e3))
      ->needs(learn)
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
      "  zerorate evaluate drives rest.csv --fit-on itself --report drives.html\n"
      "  zerorate evaluate drives run*.csv.gz --learn adis16405 --white-factor 1,3,0.333");
  return {command, [=] {
            return models->parsed() ? run_models(*traffic, *models_outputs)
                                    : run_evaluate(*options);
          }};
}

}  // namespace zerorate::cli

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/model_file.hpp"
#include "hal/linux/standard_output.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/output_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/fleet/database.hpp"
#include "host_tools/lib/fleet/population.hpp"

namespace zerorate::cli {
namespace {

using fleet::Database;

struct RunOptions {
  std::string recordings;
  InputFlags format;
  std::string axis = "all";
  std::string database = "fleet.sqlite";
  std::string shard = "1/1";
  std::string lots;
  unsigned jobs = 1;
  std::string json;
  bool alarms = false;
};

struct MergeOptions {
  std::vector<std::string> shards;
  std::string database;
};

struct ReportOptions {
  std::string database = "fleet.sqlite";
  fleet::PopulationOptions population;
  OutputOptions outputs;
  std::string csv;
  std::string limits;
  std::string limits_out;
  double test_s = 0.0;
  std::vector<std::string> fail_on;
  bool alarms = false;
};

struct PriorOptions {
  std::string database = "fleet.sqlite";
  std::string model_out;
  std::string name = "fleet";
};

struct AcceptOptions {
  InputFlags input;
  std::string axis = "all";
  std::string limits;
  std::string json;
};

fleet::Shard parse_shard(const std::string& text) {
  std::size_t index = 0;
  std::size_t count = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%zu/%zu%c", &index, &count, &rest) != 2 || index < 1 ||
      index > count) {
    throw std::invalid_argument("--shard: expected I/N with I from 1 to N, such as 3/8, found " +
                                text);
  }
  return {index - 1, count};
}

std::string to_json(const fleet::RunSummary& summary) {
  nlohmann::ordered_json bad = nlohmann::ordered_json::array();
  for (const auto& one : summary.bad) {
    bad.push_back({{"recording", one.name}, {"problem", one.problem}});
  }
  const nlohmann::ordered_json json = {
      {"schema", "zerorate.fleet-run/1"},  {"engine", Database::engine()},
      {"recordings", summary.total},       {"analysed", summary.analysed},
      {"done_before", summary.found_done}, {"repeated", summary.repeated},
      {"seconds", summary.seconds},        {"bad", bad}};
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void print_summary(const RunOptions& options, const fleet::RunSummary& summary) {
  fmt::print("{}: {} recordings, {} analysed in {:.1f} s, {} done before, {} repeated, {} bad\n",
             options.database, summary.total, summary.analysed, summary.seconds, summary.found_done,
             summary.repeated, summary.bad.size());
  for (const auto& one : summary.bad) {
    fmt::print("  {}: {}\n", hal::linux_os::printable(one.name.c_str()),
               hal::linux_os::printable(one.problem.c_str()));
  }
}

ExitCode run_run(const RunOptions& options) {
  fleet::RunOptions run{.shard = parse_shard(options.shard),
                        .jobs = options.jobs,
                        .format = to_input(options.format),
                        .axis = options.axis};
  auto recordings = fleet::list_recordings(options.recordings);
  if (!options.lots.empty()) fleet::set_lots(recordings, options.lots);
  Database database{options.database, Database::Access::write};
  const std::string format = to_text(options.format);
  database.require_format(
      options.axis == "all" ? format : fmt::format("--axis {} {}", options.axis, format));
  ProgressBar progress{"fleet"};
  run.on_progress = [&](const fleet::Progress& now) {
    progress.update(static_cast<double>(now.analysed) / static_cast<double>(now.to_analyse),
                    fmt::format("{} of {}, {:.2f} a second", now.found_done + now.analysed,
                                now.found_done + now.to_analyse, now.per_second));
  };
  const fleet::RunSummary summary = fleet::run(recordings, database, run);
  if (!options.json.empty()) write_text(options.json, to_json(summary));
  if (options.json != "-") print_summary(options, summary);
  if (summary.total > 0 && summary.bad.size() == summary.total) return bad_data;
  return options.alarms && !summary.bad.empty() ? finding : success;
}

ExitCode run_merge(const MergeOptions& options) {
  fleet::merge({options.shards.begin(), options.shards.end()}, options.database);
  fmt::print("{}: {} recordings\n", options.database,
             Database{options.database, Database::Access::read}.size());
  return success;
}

/// Whether a scheduled job has something to report.
bool has_findings(const fleet::Population& population) {
  return !population.bad.empty() || !population.warnings.empty() ||
         std::ranges::any_of(population.sensors, &fleet::Sensor::is_outlier) ||
         std::ranges::any_of(population.sensors, &fleet::Sensor::has_changed) ||
         std::ranges::any_of(population.lots, &fleet::Lot::differs);
}

ExitCode run_report(const ReportOptions& options) {
  std::optional<fleet::Limits> limits;
  if (!options.limits.empty()) limits = fleet::read_limits(options.limits);
  auto population =
      fleet::fit_population(Database{options.database, Database::Access::read}, options.population);
  population.quality = fleet::quality_of(population, limits ? &*limits : nullptr);
  if (!options.outputs.json.empty()) write_text(options.outputs.json, fleet::to_json(population));
  if (!options.outputs.report.empty()) {
    fleet::make_report(
        population, "zerorate " ZERORATE_VERSION ", zerorate fleet report --db " + options.database)
        .write(options.outputs.report);
  }
  if (!options.csv.empty()) write_text(options.csv, fleet::to_csv(population));
  if (!options.limits_out.empty()) {
    fleet::Limits made = fleet::limits_of(population, options.test_s);
    made.fail_on = options.fail_on;
    const std::string text = fleet::format_limits(made);
    static_cast<void>(fleet::parse_limits(text, options.limits_out));  // an effect may be misspelt
    write_text(options.limits_out, text);
  }
  if (options.outputs.prints_text()) fmt::print("{}", fleet::to_text(population));
  return options.alarms && has_findings(population) ? finding : success;
}

ExitCode run_prior(const PriorOptions& options) {
  const auto population =
      fleet::fit_population(Database{options.database, Database::Access::read}, {});
  for (const std::string& warning : population.warnings) {
    fmt::print(stderr, "zerorate: warning: {}\n", warning);
  }
  const model::SensorModel model = fleet::type_model(population, options.name);
  write_text(options.model_out, model::format_model(model));
  if (options.model_out != "-") {
    fmt::print("{}: order {:.3f} +- {:.3f}, B / N within a factor of {:.2f}\n", options.model_out,
               model.prior->order, model.prior->order_sigma, model.prior->amplitude_factor);
  }
  return success;
}

ExitCode run_accept(const AcceptOptions& options) {
  const fleet::Acceptance acceptance =
      fleet::accept(to_input(options.input), fleet::read_limits(options.limits), options.axis);
  if (!options.json.empty()) {
    write_text(options.json,
               fleet::to_json(acceptance,
                              std::filesystem::path(options.input.recording).filename().string()));
  }
  if (options.json != "-") {
    fmt::print("{}: {}\n", options.input.recording,
               acceptance.judgement == fleet::Judgement::too_short ? "too short to decide"
                                                                   : name(acceptance.judgement));
    for (const std::string& reason : acceptance.reasons) fmt::print("  {}\n", reason);
  }
  switch (acceptance.judgement) {
    case fleet::Judgement::pass:
      return success;
    case fleet::Judgement::fail:
      return finding;
    case fleet::Judgement::too_short:
      break;
  }
  return too_short;
}

CLI::App* add_run(CLI::App& fleet, RunOptions& options) {
  auto* command = fleet.add_subcommand("run", "Analyse every recording into a database");
  command
      ->add_option("recordings", options.recordings,
                   "folder of recordings, or list: one path a line, or CSV with the columns "
                   "recording, sensor and lot")
      ->type_name("DIR|LIST")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("--db", options.database, "database to write")->capture_default_str();
  add_axis_option(*command, options.axis);
  add_format_options(*command, options.format);
  command->add_option("--shard", options.shard, "I/N: the Ith of N parts of the work")
      ->capture_default_str();
  command->add_option("--lots", options.lots,
                      "lots of recordings without one in the list: folder (the one that each lies "
                      "in), or a regular expression whose first group in the name is the lot");
  command->add_option("--jobs", options.jobs, "threads; 0: as many as the machine has")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  command->add_option("--json", options.json, "write the summary as JSON; - is standard output");
  command->add_flag("--alarm", options.alarms, "exit code 1 where a recording cannot be used");
  command->footer(
      "Recordings that the database holds already are not analysed again, so that a run that was\n"
      "killed goes on where it was. Recordings that cannot be used are listed with the reason.\n"
      "Exit codes: 0 done, 1 with --alarm: a recording cannot be used, 2 wrong usage, 3 no\n"
      "recording could be used, or another engine wrote the database.\n"
      "Examples:\n"
      "  zerorate fleet run recordings/ --db fleet.sqlite --jobs 0\n"
      "  zerorate fleet run recordings/ --lots folder\n"
      "  zerorate fleet run recordings/ --lots '^([A-Z][0-9]+)_'\n"
      "  zerorate fleet run fleet.csv --db part3.sqlite --shard 3/8\n"
      "  zerorate fleet merge part*.sqlite --db fleet.sqlite");
  return command;
}

CLI::App* add_merge(CLI::App& fleet, MergeOptions& options) {
  auto* command = fleet.add_subcommand("merge", "Join the databases of shards");
  command->add_option("shards", options.shards, "databases")
      ->type_name("SHARD")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--db", options.database, "database to write; one that exists is added to")
      ->required();
  command->footer(
      "In any order, as often as you like: the bytes of the result depend on the contents only.\n"
      "Exit codes: 0 done, 2 wrong usage, 3 a database cannot be read, or two engines are mixed.\n"
      "Example:\n"
      "  zerorate fleet merge part1.sqlite part2.sqlite --db fleet.sqlite");
  return command;
}

void add_database_to_read(CLI::App& command, std::string& database) {
  command.add_option("--db", database, "database")->check(CLI::ExistingFile)->capture_default_str();
}

CLI::App* add_report(CLI::App& fleet, ReportOptions& options) {
  auto* command = fleet.add_subcommand(
      "report", "Distributions, causes, sensors that leave the population, lots, changes");
  add_database_to_read(*command, options.database);
  add_output_options(*command, options.outputs);
  command->add_option("--csv", options.csv, "write one line an axis; - is standard output");
  command
      ->add_option("--limits", options.limits,
                   "limits as --limits-out writes them: yield and capability (Ppk, Cpk) by them")
      ->check(CLI::ExistingFile);
  command->add_option("--limits-out", options.limits_out,
                      "write the limits for 'zerorate accept'; - is standard output");
  command
      ->add_option("--test-s", options.test_s,
                   "with --limits-out: length of the test [s], whose errors the limits allow for; "
                   "figures that it cannot decide have no limits")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--fail-on", options.fail_on,
                   "with --limits-out: effects of the diagnosis that fail a sensor, as in "
                   "periodic_disturbance,bias_jump")
      ->delimiter(',');
  command->add_flag("--alarm", options.alarms,
                    "exit code 1 where sensors leave the population or changed, lots differ, "
                    "recordings cannot be used, or a warning is given");
  command
      ->add_option("--fdr", options.population.false_discovery_rate,
                   "false discovery rate of sensors, lots and changes")
      ->check(CLI::Range(1e-6, 0.5))
      ->capture_default_str();
  command
      ->add_option("--common", options.population.common_share,
                   "an effect that a larger share of the sensors has belongs to the type")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->footer(
      "Exit codes: 0 done, 1 with --alarm: something was found, 2 wrong usage, 3 too few\n"
      "recordings, or another engine wrote them.\n"
      "Examples:\n"
      "  zerorate fleet report --db fleet.sqlite --report fleet.html\n"
      "  zerorate fleet report --db fleet.sqlite --json - --csv axes.csv\n"
      "  zerorate fleet report --db fleet.sqlite --limits-out limits.toml --test-s 60\n"
      "  zerorate fleet report --db fleet.sqlite --limits limits.toml --report yield.html\n"
      "JSON, CSV and limits are described in docs/reference/fleets.md.");
  return command;
}

CLI::App* add_prior(CLI::App& fleet, PriorOptions& options) {
  auto* command = fleet.add_subcommand(
      "prior", "Write the model from which the next sensor of the type learns");
  add_database_to_read(*command, options.database);
  command->add_option("--model-out", options.model_out, "model file; - is standard output")
      ->required();
  command->add_option("--name", options.name, "name of the model")->capture_default_str();
  command->footer(
      "Exit codes: 0 done, 2 wrong usage, 3 too few recordings, or another engine wrote them.\n"
      "Examples:\n"
      "  zerorate fleet prior --db fleet.sqlite --model-out type.toml\n"
      "  zerorate replay drive.csv.gz --model type.toml");
  return command;
}

}  // namespace

Command add_fleet(CLI::App& app) {
  auto* command =
      app.add_subcommand("fleet", "Thousands of recordings: population, outliers, lots, prior");
  command->require_subcommand(1);
  const auto run = std::make_shared<RunOptions>();
  const auto merge = std::make_shared<MergeOptions>();
  const auto report = std::make_shared<ReportOptions>();
  const auto prior = std::make_shared<PriorOptions>();
  const CLI::App* const run_app = add_run(*command, *run);
  const CLI::App* const merge_app = add_merge(*command, *merge);
  const CLI::App* const report_app = add_report(*command, *report);
  add_prior(*command, *prior);
  return {command, [=] {
            if (run_app->parsed()) return run_run(*run);
            if (merge_app->parsed()) return run_merge(*merge);
            if (report_app->parsed()) return run_report(*report);
            return run_prior(*prior);
          }};
}

Command add_accept(CLI::App& app) {
  auto* command = app.add_subcommand("accept", "End-of-line test: one recording against limits");
  const auto options = std::make_shared<AcceptOptions>();
  add_input_options(*command, options->input);
  add_axis_option(*command, options->axis);
  command
      ->add_option("--limits", options->limits,
                   "limits, as 'zerorate fleet report --limits-out' writes them")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--json", options->json, "write the result as JSON; - is standard output");
  command->footer(
      "A figure passes where its 95 % interval lies inside the limits, fails where it lies\n"
      "outside, and is too short to decide where a limit lies in between.\n"
      "Exit codes: 0 pass, 1 fail, 2 wrong usage, 3 data or limits that cannot be used, 4 too\n"
      "short to decide.\n"
      "Examples:\n"
      "  zerorate accept S0001.csv.gz --limits limits.toml\n"
      "  zerorate accept S0001.csv.gz --limits limits.toml --json -\n"
      "JSON and limits are described in docs/reference/fleets.md.");
  return {command, [options] { return run_accept(*options); }};
}

}  // namespace zerorate::cli

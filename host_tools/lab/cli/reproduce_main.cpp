/// @file
/// `zerorate-reproduce`, the table and the figures of the paper.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/output_options.hpp"
#include "host_tools/cli/program.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lab/paper/presentation.hpp"

namespace zerorate::cli {
namespace {

using parallel::Progress;
using report::Presentation;

struct ReproduceOptions {
  std::string experiment;
  paper::SimulationOptions simulation;
  double white = 0.0;
  std::vector<std::string> data;
  double highest_rate_hz = 20.0;
  OutputOptions outputs;
};

std::vector<paper::RestRecording> recordings(const ReproduceOptions& options) {
  if (options.data.empty()) return {};
  return paper::read_rest_recordings({options.data.begin(), options.data.end()},
                                     options.highest_rate_hz);
}

paper::MeasuredOptions measured_options(const ReproduceOptions& options) {
  return {.lengths = options.simulation.lengths,
          .decades = options.simulation.decades,
          .threads = options.simulation.threads};
}

/// Work under a progress bar of its own.
template <class Work>
auto watched(const char* what, Work work) {
  ProgressBar bar{what};
  return work(Progress{[&bar](double share) { bar.update(share); }});
}

Presentation table1(const ReproduceOptions& options) {
  paper::Table1 table{.options = options.simulation};
  table.simulated = watched("simulating Table I", [&](const Progress& progress) {
    return paper::simulate_table1(options.simulation, progress);
  });
  table.orders = watched("other orders", [&](const Progress& progress) {
    auto fewer = options.simulation;
    fewer.runs = std::max<std::size_t>(2, fewer.runs / 4);
    return paper::compare_orders({0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}, fewer, progress);
  });
  table.costs = paper::measure_filter_cost({500, 1000, 2000, 4000});
  if (!options.data.empty()) {
    table.measured = watched("measured sets", [&](const Progress& progress) {
      return paper::measure_table1(recordings(options), measured_options(options), progress);
    });
  }
  return paper::present(table);
}

Presentation make(ReproduceOptions options, bool lengths_given) {
  if (options.experiment == "table1") return table1(options);
  if (options.experiment == "figure1") {
    return paper::present(paper::make_figure1(recordings(options), options.simulation.seed));
  }
  if (!lengths_given) options.simulation.lengths = {.calibration = 1200, .prediction = 1200};
  if (options.experiment == "figure2") {
    return paper::present(paper::make_figure2(options.simulation), 2);
  }
  return paper::present(paper::make_figure3(recordings(options), measured_options(options)), 3);
}

ExitCode run_reproduce(ReproduceOptions options, bool lengths_given) {
  options.simulation.noise.white_variance = options.white * options.white;
  present(make(options, lengths_given),
          fmt::format("zerorate {}, zerorate-reproduce {} --runs {} --order {:g} --seed {}",
                      ZERORATE_VERSION, options.experiment, options.simulation.runs,
                      options.simulation.noise.order, options.simulation.seed),
          options.outputs);
  return success;
}

/// Adds the options to the program itself, which has one command.
Command add_options(CLI::App& app, ReproduceOptions& options) {
  auto& simulation = options.simulation;
  app.add_option("EXPERIMENT", options.experiment, "table1, figure1, figure2 or figure3")
      ->required()
      ->check(CLI::IsMember({"table1", "figure1", "figure2", "figure3"}));
  app.add_option("--runs", simulation.runs, "simulated sets; other orders take a quarter")
      ->check(CLI::Range(2, 1'000'000))
      ->capture_default_str();
  app.add_option("--order", simulation.noise.order, "d of the simulated noise")
      ->check(CLI::Range(0.05, 0.95))
      ->capture_default_str();
  app.add_option("--white", options.white, "sigma of additional white noise; 1/f noise: 2.5")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--decades", simulation.decades, "lags of the decade filter")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  auto* calibration = app.add_option("--calibration", simulation.lengths.calibration, "samples")
                          ->check(CLI::Range(250, 10'000))
                          ->capture_default_str();
  auto* prediction = app.add_option("--prediction", simulation.lengths.prediction, "samples")
                         ->check(CLI::Range(1, 10'000))
                         ->capture_default_str();
  app.add_option("--data", options.data,
                 "recordings at rest, or folders of them: the measured half of table1, "
                 "curves of figure1, the run of figure3 (its first recording; the noise is "
                 "fitted on the second)");
  app.add_option("--highest-rate", options.highest_rate_hz,
                 "leave out recordings that are sampled faster [Hz]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", simulation.seed, "another seed, other runs")->capture_default_str();
  app.add_option("--threads", simulation.threads,
                 "0: as many as there are; the figures do not depend on it")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  add_output_options(app, options.outputs);
  app.footer(
      "Examples:\n"
      "  zerorate-reproduce table1 --runs 1000\n"
      "  zerorate-reproduce table1 --runs 200 --order 0.7 --json -\n"
      "  zerorate-reproduce table1 --data static/ --report table1.html\n"
      "  zerorate-reproduce figure1 --data run1_1hz.csv.gz --report figure1.html\n"
      "  zerorate-reproduce figure3 --data run1_1hz.csv.gz run2_1hz.csv.gz --report figure3.html\n"
      "What is reproduced and what differs: docs/design/paper.md.");
  return {&app, [&options, calibration, prediction] {
            return run_reproduce(options, calibration->count() + prediction->count() > 0);
          }};
}

std::vector<Command> add(CLI::App& app) {
  static ReproduceOptions options;
  return {add_options(app, options)};
}

}  // namespace
}  // namespace zerorate::cli

int main(int argc, char** argv) {
  return zerorate::cli::run_program(
      "Reproduces the table and the figures of the paper, with errors", "zerorate-reproduce",
      zerorate::cli::add, argc, argv);
}

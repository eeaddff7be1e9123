#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/output_options.hpp"
#include "host_tools/cli/reference_options.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/contest/comparison.hpp"

namespace zerorate::cli {
namespace {

struct CompareOptions {
  std::vector<std::string> logs;
  InputFlags format;
  ReplayFlags replay;
  TruthFlags truth;
  std::string against = "last-mean";
  double script_seconds = contest::Rival{}.limit_s;
  unsigned threads = 0;
  OutputOptions outputs;
};

contest::Rival to_rival(const CompareOptions& options) {
  contest::Rival rival = contest::parse_rival(options.against);
  rival.limit_s = options.script_seconds;
  return rival;
}

ExitCode run_compare(const CompareOptions& options) {
  const contest::ComparisonOptions comparison{
      .replay = to_replay_options(options.replay),
      .rival = to_rival(options),
      .axis = options.replay.axis.empty() ? "all" : options.replay.axis,
      .format = to_input(options.format),
      .truth = to_truth_options(options.truth),
      .threads = options.threads};
  const report::Presentation presentation = [&] {
    ProgressBar bar{"comparing"};
    return contest::present(
        contest::compare(options.logs, comparison, [&bar](double share) { bar.update(share); }));
  }();
  present(presentation, "zerorate " ZERORATE_VERSION ", zerorate compare", options.outputs);
  if (options.outputs.prints_text()) fmt::print("{}\n", presentation.lead);
  return success;
}

}  // namespace

Command add_compare(CLI::App& app) {
  auto* command = app.add_subcommand(
      "compare", "Compare the node with a predictor that you have, on your logs");
  const auto options = std::make_shared<CompareOptions>();
  command->add_option("LOG", options->logs, "recordings of drives with their stops")
      ->required()
      ->check(CLI::ExistingPath);
  command
      ->add_option("--against", options->against,
                   "last-mean, the mean of the last stop; exponential:SECONDS, an exponential "
                   "mean of the samples at rest, held on the way; column:NAME (or three names), "
                   "bias estimates in the log; script:COMMAND, a program that reads the rows at "
                   "rest and writes a bias for each stop")
      ->capture_default_str();
  command
      ->add_option("--script-seconds", options->script_seconds,
                   "time that the program of --against may take for a log [s]")
      ->check(CLI::Range(0.1, 86'400.0))
      ->capture_default_str();
  add_format_options(*command, options->format);
  add_replay_flags(*command, options->replay);
  add_truth_flags(*command, options->truth);
  command
      ->add_option("--threads", options->threads,
                   "0: as many as there are; the figures do not depend on it")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  add_output_options(*command, options->outputs);
  command->footer(
      "Each stop's first seconds show how wrong the bias was that was predicted for it: no\n"
      "reference is needed. With a reference's heading the drives are compared too. Figures are\n"
      "in pairs, with intervals over logs, or over stops where there are fewer than five logs.\n"
      "Examples:\n"
      "  zerorate compare log1.csv log2.csv log3.csv --against exponential:30 --model lsm6dso\n"
      "  zerorate compare logs/*.csv --axis z --against column:my_bias_dps --json -\n"
      "  zerorate compare logs/*.csv --against 'script:python3 my_filter.py'\n"
      "  zerorate compare drive.csv --against last-mean --report compare.html");
  return {command, [options] { return run_compare(*options); }};
}

}  // namespace zerorate::cli

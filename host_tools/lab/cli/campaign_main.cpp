/// @file
/// `zerorate-campaign`, the blind campaign: recordings whose hidden effect only this program knows
/// are diagnosed by the command line, and the answers are counted.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/program.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lab/campaign/answer.hpp"
#include "host_tools/lab/campaign/blind_recording.hpp"
#include "host_tools/lab/campaign/gain_summary.hpp"
#include "host_tools/lab/campaign/tally.hpp"
#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

namespace zerorate::campaign {
namespace {

/// The folder in which one recording after the other is written; removed at the end.
class RecordingFolder {
 public:
  RecordingFolder() {
    std::string name =
        (std::filesystem::temp_directory_path() / "zerorate-campaign-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::system_error(errno, std::generic_category(), name);
    }
    path_ = name;
  }
  ~RecordingFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  RecordingFolder(const RecordingFolder&) = delete;
  RecordingFolder& operator=(const RecordingFolder&) = delete;

  [[nodiscard]] std::filesystem::path recording() const { return path_ / "recording.csv"; }

 private:
  std::filesystem::path path_;
};

/// The `zerorate` that stands beside this program.
std::string neighbouring_program() {
  return std::filesystem::read_symlink("/proc/self/exe").replace_filename("zerorate").string();
}

struct CampaignOptions {
  BlindOptions blind;
  std::string zerorate = neighbouring_program();
  std::size_t runs = 10 * campaign::Round::kRuns;
  std::string document;
  std::string commit;
  std::string json;
  std::pair<std::size_t, std::string> write_run;
  bool gain = false;
  std::size_t gain_recordings = 20;  ///< recordings with each effect
};

/// A program that fails has not answered; the campaign goes on.
Answer answer_of(const CampaignOptions& options, const std::filesystem::path& recording) {
  try {
    return options.blind.drives ? diagnose_drives(options.zerorate, recording)
                                : diagnose(options.zerorate, recording);
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return {.verdict = "failed"};
  }
}

Tally run_campaign(const CampaignOptions& options) {
  const RecordingFolder folder;
  const std::filesystem::path recording = folder.recording();
  Tally tally{options.blind};
  cli::ProgressBar progress{fmt::format("{:g} nats", options.blind.nats)};
  for (std::size_t run = 0; run < options.runs; ++run) {
    const BlindRecording blind = draw_blind_recording(options.blind, run);
    write_recording(blind, recording);
    tally.add(run, blind, answer_of(options, recording));
    progress.update(static_cast<double>(run + 1) / static_cast<double>(options.runs));
  }
  return tally;
}

/// Recordings that hide the effect, until in so many of them it was named and a gain was measured.
GainSummary gains_of(const std::string& effect, const CampaignOptions& options) {
  const RecordingFolder folder;
  const std::filesystem::path recording = folder.recording();
  BlindOptions scenario_options = options.blind;
  scenario_options.only = effect;
  scenario_options.finest_step_share = 1.0;
  GainSummary gains{effect, scenario_options.seed};
  cli::ProgressBar progress{effect};
  for (std::size_t run = 0; run < 2 * options.gain_recordings; ++run) {
    const BlindRecording blind = draw_blind_recording(scenario_options, run);
    write_recording(blind, recording);
    const Answer answer = answer_of(options, recording);
    if (score(blind, answer).named && std::isfinite(answer.gain.rsse_ratio)) {
      gains.add(answer.gain,
                std::ranges::find(answer.extensions, effect) != answer.extensions.end());
    }
    progress.update(static_cast<double>(gains.size()) /
                    static_cast<double>(options.gain_recordings));
    if (gains.size() == options.gain_recordings) break;
  }
  return gains;
}

/// A document with figures between two marks. It is read before the figures are made, so that a
/// wrong path is told at once.
class Document {
 public:
  /// Throws std::runtime_error where there are no marks.
  explicit Document(std::string path) : path_(std::move(path)) {
    static constexpr std::string_view kBegin = "<!-- figures -->\n";
    static constexpr std::string_view kEnd = "<!-- end of figures -->\n";
    std::ifstream file{path_};
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto begin = text.find(kBegin);
    const auto end = text.find(kEnd);
    if (begin == std::string::npos || end == std::string::npos) {
      throw std::runtime_error(path_ + ": cannot be read, or has no lines <!-- figures --> and " +
                               "<!-- end of figures --> between which the figures belong");
    }
    before_ = text.substr(0, begin + kBegin.size());
    after_ = text.substr(end);
  }

  void write(const std::string& figures) const {
    cli::write_text(path_, before_ + figures + after_);
  }

 private:
  std::string path_;
  std::string before_;
  std::string after_;
};

void run_document(CampaignOptions options) {
  const Document document{options.document};
  std::string figures;
  for (const double nats : {40.0, 25.0}) {
    options.blind.nats = nats;
    const Tally tally = run_campaign(options);
    figures += fmt::format(
        "\n## {:g} nats\n\n{} recordings of {}, seed {}, commit {}.\n\n{}", nats, options.runs,
        options.blind.drives ? std::string("an hour")
                             : fmt::format("{} samples", options.blind.samples),
        options.blind.seed, options.commit.empty() ? "unknown" : options.commit, tally.markdown());
  }
  document.write(figures + "\n");
}

void run_gain(const CampaignOptions& options) {
  std::optional<Document> document;
  if (!options.document.empty()) document.emplace(options.document);
  std::string table =
      fmt::format("\n{} recordings of {} samples for each effect, {:g} nats, seed {}.\n\n{}",
                  options.gain_recordings, options.blind.samples, options.blind.nats,
                  options.blind.seed, GainSummary::header());
  for (const sizing::EffectEntry& entry : sizing::catalogue()) {
    if (!options.blind.only.empty() && entry.name != options.blind.only) continue;
    table += gains_of(std::string(entry.name), options).row();
  }
  if (document) {
    document->write(table + "\n");
  } else {
    fmt::print("{}", table);
  }
}

void run(const CampaignOptions& options) {
  if (!options.write_run.second.empty()) {
    const auto& [number, path] = options.write_run;
    const BlindRecording blind = draw_blind_recording(options.blind, number);
    write_recording(blind, path);
    fmt::print("{} ({})\n", fmt::join(blind.truth, " + "), blind.description);
    return;
  }
  if (options.gain) {
    run_gain(options);
    return;
  }
  if (!options.document.empty()) {
    run_document(options);
    return;
  }
  const Tally tally = run_campaign(options);
  if (options.json != "-") fmt::print("{}\n", tally.markdown());
  if (!options.json.empty()) cli::write_text(options.json, tally.json() + "\n");
}

/// Adds the options to the program itself, which has one command.
cli::Command add_options(CLI::App& app, CampaignOptions& options) {
  app.footer(
      "Examples:\n"
      "  zerorate-campaign                                    ten rounds, as text\n"
      "  zerorate-campaign --runs 32 --only bias_jump         one effect\n"
      "  zerorate-campaign --document FILE.md                 both sizes, written into the "
      "document\n"
      "  zerorate-campaign --gain --document FILE.md          what the extended models are worth\n"
      "  zerorate-campaign --write-run 17 recording.csv       one recording, for a look");
  app.add_option("--runs", options.runs, "recordings; a round has 34")->capture_default_str();
  app.add_option("--nats", options.blind.nats, "loss of the best base model to each effect [nats]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", options.blind.seed, "seed of everything that is drawn")
      ->capture_default_str();
  app.add_option("--samples", options.blind.samples, "samples of each recording")
      ->check(CLI::Range(1000, 1'000'000))
      ->capture_default_str();
  app.add_option("--rate-hz", options.blind.rate_hz, "sample rate, in place of a drawn one")
      ->check(CLI::PositiveNumber);
  app.add_option("--only", options.blind.only, "hide this effect in every recording");
  app.add_option("--zerorate", options.zerorate, "the program that is tried")
      ->check(CLI::ExistingFile)
      ->capture_default_str();
  app.add_option("--json", options.json, "write the counts as JSON; - for standard output");
  app.add_option("--document", options.document,
                 "run at 40 and at 25 nats and write the tables into this document");
  app.add_flag("--standstills", options.blind.standstills,
               "recordings of twelve standstills in as many attitudes; a round has 6");
  app.add_flag("--drives", options.blind.drives,
               "hours of drives with a reference; a round has 22");
  app.add_flag("--gain", options.gain,
               "measure what the extended models are worth instead: an effect after the other");
  app.add_option("--recordings", options.gain_recordings, "recordings of each effect, with --gain")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--commit", options.commit, "commit of the program under test, for the document");
  app.add_option("--write-run", options.write_run, "write the recording of one run and stop");
  return {&app, [&options] {
            run(options);
            return cli::success;
          }};
}

std::vector<cli::Command> add(CLI::App& app) {
  static CampaignOptions options;
  return {add_options(app, options)};
}

}  // namespace
}  // namespace zerorate::campaign

int main(int argc, char** argv) {
  return zerorate::cli::run_program(
      "Diagnoses recordings with hidden effects and counts the answers", "zerorate-campaign",
      zerorate::campaign::add, argc, argv);
}

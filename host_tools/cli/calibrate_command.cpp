#include <fmt/format.h>
#include <poll.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "firmware/model/model_file.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/live_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/calibrate/calibration.hpp"
#include "host_tools/lib/calibrate/presentation.hpp"
#include "host_tools/lib/calibrate/turn_guide.hpp"
#include "host_tools/lib/live/source.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::cli {
namespace {

using calibrate::TurnGuide;

struct TurnsFlags {
  std::string recording;
  LiveOptions live;
  ChipOptions chip;
  int turns = 10;
  bool is_one_way = false;
  double rest_s = 10.0;
  double mark_sigma_deg = 2.0;
  double drift_percent = 0.2;
  std::string model;
  std::string model_out;
  std::string summary;

  /// Model that the node runs with, by name or file; empty: not known.
  [[nodiscard]] std::string model_of_node() const {
    if (chip.is_given()) return model_of_chip(chip);
    return recording.empty() ? model : recorded_model();
  }
  /// Model of the node that a recording is run through.
  [[nodiscard]] std::string recorded_model() const { return model.empty() ? "lsm6dso" : model; }
  [[nodiscard]] TurnGuide::Settings guide() const {
    const std::size_t wanted = is_one_way ? 1 : 2;
    return {.wanted = recording.empty() ? wanted : 0, .rest_s = rest_s};
  }
};

/// Model whose tolerance is held against the result; none where none is given.
std::optional<model::SensorModel> model_of(const TurnsFlags& flags) {
  if (!flags.model.empty()) return model::load_model(flags.model);
  if (!flags.chip.configuration.empty()) return model::load_model(model_of_chip(flags.chip));
  if (flags.model_out.empty()) return std::nullopt;
  throw std::invalid_argument(
      "--model-out: give --model, too, whose other tables the written one has");
}

model::ScaleFactor scale_factor_of(const std::optional<model::SensorModel>& model) {
  return model ? model->scale_factor.value_or(model::ScaleFactor{}) : model::ScaleFactor{};
}

/// Known errors of the scale factors that the node takes off before its turn is summed.
std::optional<std::array<double, 3>> taken_off(const TurnsFlags& flags) {
  const std::string model = flags.model_of_node();
  if (model.empty()) return std::nullopt;
  return scale_factor_of(model::load_model(model)).error;
}

/// Follows a node until the guide is done, the messages end, or a signal says so.
void guide_live(const TurnsFlags& flags, TurnGuide& guide) {
  using Clock = std::chrono::steady_clock;
  const auto signals = open_end_signals();  // before any thread: all inherit that they are blocked
  const auto source = flags.chip.is_given() ? open_chip(flags.chip) : open_source(flags.live);
  std::vector<wire::NumberedMessage> messages;
  live::Tally tally;
  tally.every = &messages;
  ProgressBar progress{"calibrating"};
  SilenceNotice silence{source->name()};
  Clock::time_point heard_at = Clock::now();
  bool goes_on = true;
  while (goes_on && guide.stage() != TurnGuide::Stage::done) {
    std::array<pollfd, 2> events{{{.fd = signals.get(), .events = POLLIN, .revents = 0},
                                  {.fd = source->descriptor(), .events = POLLIN, .revents = 0}}};
    constexpr int kPause_ms = 200;
    (void)poll(events.data(), events.size(), kPause_ms);
    if (events[1].revents != 0) goes_on = source->receive(tally);
    if (events[0].revents != 0) goes_on = false;
    if (!messages.empty()) heard_at = Clock::now();
    for (const wire::NumberedMessage& message : messages) guide.take(message);
    messages.clear();
    silence.tell(tally.messages,
                 std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - heard_at));
    progress.update(std::nullopt, calibrate::instruction(guide, flags.guide(), flags.turns));
  }
}

void write_model(const TurnsFlags& flags, model::SensorModel model,
                 const calibrate::Calibration& calibration) {
  model.scale_factor = calibrate::calibrated_scale_factor(calibration);
  write_text(flags.model_out, model::format_model(model));
  if (flags.model_out != "-" && flags.summary != "-") {
    fmt::print("{}: the model with the scale factor of axis {}\n", flags.model_out,
               "xyz"[calibration.axis]);
  }
}

ExitCode run_turns(const TurnsFlags& flags, const PlayRecording& play_recording) {
  const std::optional<model::SensorModel> model = model_of(flags);
  const calibrate::CalibrationSettings settings{
      .turns = flags.turns,
      .mark_sigma_rad = flags.mark_sigma_deg * units::kRadPerDeg,
      .tolerance = scale_factor_of(model),
      .taken_off = taken_off(flags),
      .drift_sigma = 0.01 * flags.drift_percent};
  TurnGuide guide{flags.guide()};
  if (flags.recording.empty()) {
    guide_live(flags, guide);
  } else {
    play_recording(flags.recording, flags.recorded_model(),
                   [&](const wire::NumberedMessage& message) { guide.take(message); });
  }
  guide.finish();
  const calibrate::Calibration calibration = calibrate::calibrate(guide, settings);
  if (!flags.summary.empty()) write_text(flags.summary, calibrate::to_json(calibration));
  if (guide.messages() == 0) return finding;
  if (!calibration.fit) {
    throw std::runtime_error(
        fmt::format("no scale factor: {}", fmt::join(calibration.problems, "; ")));
  }
  if (flags.summary != "-" && flags.model_out != "-") fmt::print("{}", to_text(calibration));
  if (!flags.model_out.empty()) write_model(flags, *model, calibration);
  return calibration.contradicts_tolerance() ? finding : success;
}

void add_turns_options(CLI::App& command, TurnsFlags& flags) {
  command.add_option("--turns", flags.turns, "full turns of each sense, about one axis")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_flag("--one-way", flags.is_one_way,
                   "end after the first sense; the asymmetry is not measured then");
  command.add_option("--rest", flags.rest_s, "rest before and after the turns [s]")
      ->check(CLI::Range(3.0, 3600.0))
      ->capture_default_str();
  command
      .add_option("--mark-sigma-deg", flags.mark_sigma_deg,
                  "error of a stop at the mark, standard deviation [deg]")
      ->check(CLI::Range(0.001, 90.0))
      ->capture_default_str();
  command
      .add_option(
          "--drift-percent", flags.drift_percent,
          "change of the scale factor after this by temperature and age, standard deviation")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command.add_option(
      "--model", flags.model,
      "sensor model: a TOML file or a name from 'zerorate model list'; the one that "
      "the node runs with. Its tolerance is held against the result, 1 % without it");
  command.add_option("--model-out", flags.model_out,
                     "write the model with the known error of this axis, and the tolerance of what "
                     "is left");
  command.add_option("--summary", flags.summary,
                     "write the figures as JSON; - for standard output");
}

}  // namespace

Command add_calibrate(CLI::App& app, const PlayRecording& play_recording) {
  const auto flags = std::make_shared<TurnsFlags>();
  auto* command = app.add_subcommand("calibrate", "Measure what rest does not show: turns by hand");
  command->require_subcommand(1);
  auto* turns = command->add_subcommand(
      "turns", "The scale factor of an axis: stand still, turn, stand still, turn back");
  add_live_options(*turns, flags->live);
  add_chip_options(*turns, flags->chip);
  if (play_recording) {
    auto* recording = turns->add_option("RECORDING", flags->recording,
                                        "recording of such turns instead of a node that runs");
    for (const char* source : {"--udp", "--unix", "--serial", "--json", "--config", "--chip"}) {
      recording->excludes(turns->get_option(source));
    }
  }
  add_turns_options(*turns, *flags);
  const std::string recording_example =
      play_recording ? "  zerorate calibrate turns --model lsm6dso turns.csv.gz\n" : "";
  turns->footer(
      "Examples:\n"
      "  zerorate calibrate turns --turns 10\n"
      "  zerorate calibrate turns --serial /dev/ttyUSB0 --model mine.toml --model-out mine.toml\n"
      "  zerorate calibrate turns --config /etc/zerorate/zerorated.toml --mark-sigma-deg 1\n" +
      recording_example +
      "Stand still for ten seconds, turn the device ten times about one axis, stop at the mark\n"
      "from which it began, stand still; then the same the other way. A pause to change the grip\n"
      "is no end. Exit code 1 where the result contradicts the tolerance, 3 where there is none,\n"
      "as after a wrong count. docs/how-to/calibrate-turns.md says how sure the result is.");
  return {command, [flags, play_recording] { return run_turns(*flags, play_recording); }};
}

}  // namespace zerorate::cli

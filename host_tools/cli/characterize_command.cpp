#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/model_file.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/output_options.hpp"
#include "host_tools/cli/progress_bar.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/text_output.hpp"
#include "host_tools/lib/identify/characterization_report.hpp"
#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/identify/motion_at_rest.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::cli {
namespace {

using units::kDegPerRad;
using units::kDphPerRadS;

struct CharacterizeOptions {
  InputFlags input;
  std::string axis = "all";
  std::string still_from = "odometer";
  std::string order = "free";
  std::vector<std::string> others;
  OutputOptions outputs;
  std::string model_out;
};

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::optional<double> parse_order(const std::string& text) {
  if (text == "free") return std::nullopt;
  double order = 0.0;
  if (!CLI::detail::lexical_cast(text, order) || !(order >= 0.05 && order <= 0.95)) {
    throw std::invalid_argument("--order: expected free or a number from 0.05 to 0.95, found " +
                                text);
  }
  return order;
}

/// Further recordings, read as the first one was.
/// @param doubts  set to what speaks against rest and is not certain
std::vector<identify::RestSamples> read_others(const CharacterizeOptions& options,
                                               std::vector<std::string>& doubts) {
  std::vector<identify::RestSamples> others;
  for (const std::string& name : options.others) {
    InputFlags input = options.input;
    input.recording = name;
    recording::Reader reader{to_input(input)};
    identify::RestSamples samples = identify::read_rest(reader, rest_source(options.still_from));
    for (std::string& doubt : identify::require_rest(samples)) {
      doubts.push_back(name + ": " + std::move(doubt));
    }
    others.push_back(std::move(samples));
  }
  return others;
}

/// @param doubts  set to what speaks against rest and is not certain
identify::Characterization run_identification(const CharacterizeOptions& options,
                                              std::vector<std::string>& doubts) {
  const std::optional<double> order = parse_order(options.order);
  recording::Reader reader{to_input(options.input)};
  const auto axes = chosen_axes(options.axis, reader.columns().axis_count);
  identify::RestOptions rest;
  ProgressBar progress{"characterizing"};
  // Reading takes about half the time.
  rest.on_progress = [&](std::optional<double> share) {
    progress.update(share ? std::optional{0.5 * *share} : std::nullopt);
  };
  const identify::RestSamples samples =
      identify::read_rest(reader, rest_source(options.still_from), rest);
  doubts = identify::require_rest(samples);
  const identify::CharacterizeOptions settings{
      .recording = file_name(options.input.recording),
      .axes = axes,
      .order = order,
      .on_progress = [&](double share) { progress.update(0.5 + 0.5 * share); }};
  identify::Characterization result = identify::characterize(samples, settings);
  if (options.others.empty()) return result;
  const std::vector<identify::RestSamples> others = read_others(options, doubts);
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (others[i].axis_count != samples.axis_count) {
      throw recording::DataError(fmt::format("{}: {} axes, where {} has {}: not one sensor",
                                             options.others[i], others[i].axis_count,
                                             settings.recording, samples.axis_count));
    }
    result.further_recordings.push_back(file_name(options.others[i]));
  }
  identify::compare_recordings(samples, others, settings, result);
  return result;
}

void print_line(std::string_view what, const std::string& figure, std::string_view remark) {
  fmt::print("  {:<24}{:<29}{}\n", what, figure, remark);
}

void print_flicker(const identify::InnovationsFit& fit) {
  if (!fit.flicker) {
    print_line("bias instability B", "not detectable", fmt::format("p = {:.2g}", fit.p_value));
    return;
  }
  print_line("bias instability B", identify::text(fit.flicker->bias_instability_rad_s, kDphPerRadS),
             "deg/h; Allan floor 0.664 B if d = 1/2");
  print_line("order d", identify::text(fit.flicker->order),
             identify::explain(fit.flicker->order_source));
}

void print_axis(const identify::AxisCharacterization& axis) {
  const auto& arw = axis.fit.angle_random_walk_rad_per_sqrt_s;
  fmt::print("\naxis {}\n", axis.axis);
  print_line("angle random walk N", identify::text(arw, kDegPerRad),
             "deg/s/sqrt(Hz), two-sided: a data sheet's figure over sqrt(2)");
  print_line("", identify::text(arw, 60.0 * kDegPerRad), "deg/sqrt(h)");
  print_flicker(axis.fit);
  if (axis.local_whittle_order) {
    print_line("order by local Whittle",
               fmt::format("{:.2f} +- {:.2f}", axis.local_whittle_order->value,
                           axis.local_whittle_order->standard_error),
               "without a model; white noise biases it downwards");
  }
  if (!axis.allan.empty()) {
    const auto& floor = axis.allan_floor();
    print_line("Allan deviation floor", fmt::format("{:.3g}", floor.adev * kDphPerRadS),
               fmt::format("deg/h, at {:.3g} s", floor.tau_s));
  }
  for (const std::string& remark : axis.remarks) fmt::print("  note: {}\n", remark);
}

void print_sameness(const identify::Characterization& result, const identify::Sameness& axis) {
  fmt::print("\naxis {}, {} recordings: {} (p = {:.2g})\n", axis.axis, axis.alone.size(),
             axis.holds() ? "one parameter set serves all"
                          : "the noise has changed, one parameter set does not serve",
             axis.p_value);
  const auto print = [](const std::string& name, const identify::InnovationsFit& fit) {
    print_line(name, "N " + identify::text(fit.angle_random_walk_rad_per_sqrt_s, kDegPerRad),
               fit.flicker ? "B " + identify::text(fit.flicker->bias_instability_rad_s, kDphPerRadS)
                           : std::string("no flicker noise"));
  };
  print(result.recording, axis.alone.front());
  for (std::size_t i = 1; i < axis.alone.size(); ++i) {
    print(result.further_recordings[i - 1], axis.alone[i]);
  }
  print("together", axis.together);
}

void print_characterization(const identify::Characterization& result) {
  fmt::print("{}: {} samples every {:.6g} s, {:.0f} s at rest; filter ticks of {:.6g} s\n",
             result.recording, result.rows, static_cast<double>(result.sample_period.ns()) * 1e-9,
             result.rest_s, static_cast<double>(result.tick.ns()) * 1e-9);
  print_findings(result.findings);
  if (result.rows_moving > 0) {
    fmt::print("  note: {} rows left out because the vehicle moved\n", result.rows_moving);
  }
  fmt::print("Figures in brackets are 95 % intervals.\n");
  for (const auto& axis : result.axes) print_axis(axis);
  for (const auto& sameness : result.sameness) print_sameness(result, sameness);
}

/// A drift beyond any flicker noise is a finding: the model does not describe the sensor.
ExitCode judge(const identify::Characterization& result) {
  const bool drifts = std::ranges::any_of(result.axes, [](const auto& axis) {
    return axis.fit.flicker && axis.fit.flicker->order_source == identify::OrderSource::limit;
  });
  return drifts ? finding : success;
}

ExitCode run_characterize(const CharacterizeOptions& options) {
  std::vector<std::string> doubts;
  const identify::Characterization result = run_identification(options, doubts);
  if (!options.outputs.report.empty()) {
    identify::make_report(
        result, "zerorate " ZERORATE_VERSION ", zerorate characterize " + result.recording)
        .write(options.outputs.report);
  }
  if (!options.outputs.json.empty()) write_text(options.outputs.json, identify::to_json(result));
  if (options.outputs.prints_text()) {
    for (const std::string& doubt : doubts) fmt::print("  note: {}\n", doubt);
    print_characterization(result);
  }
  if (!options.model_out.empty()) {
    const auto& axis = identify::middle_axis(result);
    const auto same = std::ranges::find(result.sameness, axis.axis, &identify::Sameness::axis);
    const bool is_of_all = same != result.sameness.end() && same->holds();
    write_text(options.model_out, model::format_model(is_of_all ? same->model : axis.model));
    if (options.outputs.prints_text()) {
      fmt::print("\n{}: the model of axis {}{}{}\n", options.model_out, axis.axis,
                 result.axes.size() > 1 ? ", the one with the median slow noise" : "",
                 is_of_all ? ", fitted to all recordings" : "");
    }
  }
  return doubts.empty() ? judge(result) : finding;
}

}  // namespace

Command add_characterize(CLI::App& app) {
  auto* command =
      app.add_subcommand("characterize", "Identify a sensor's noise from a recording at rest");
  const auto options = std::make_shared<CharacterizeOptions>();
  add_input_options(*command, options->input);
  add_rest_options(*command, options->still_from);
  command->add_option("--axis", options->axis, "x, y, z or all")
      ->check(CLI::IsMember({"x", "y", "z", "all"}))
      ->capture_default_str();
  command
      ->add_option("--order", options->order,
                   "order d of the flicker noise: free (estimated where the recording is long "
                   "enough, else 1/2) or a number from 0.05 to 0.95")
      ->capture_default_str();
  command->add_option("--with", options->others,
                      "further recordings of the same sensor: tells whether one parameter set "
                      "serves all (a test that errs for 1 % of unchanged sensors); if so "
                      "--model-out is fitted to all");
  add_output_options(*command, options->outputs);
  command->add_option("--model-out", options->model_out,
                      "write the sensor model for 'zerorate replay --model'; with several axes, "
                      "that of the axis with the median slow noise");
  command->footer(
      "Rows in which the vehicle moves, by an odometer or still column, are left out.\n"
      "The error of the order by local Whittle is that of its finite number of frequencies; the\n"
      "textbook's 1/(2 sqrt(m)) is 15 % too low at m = 44 (docs/design/identification.md).\n"
      "Exit codes: 0 done (also if no flicker noise is detectable), 1 the bias drifts more than\n"
      "flicker noise can, or the recording may not be one at rest, 2 wrong usage, 3 data that "
      "cannot\n"
      "be used, as of a sensor that was turned.\n"
      "Examples:\n"
      "  zerorate characterize rest.csv.gz --report noise.html --model-out mine.toml\n"
      "  zerorate replay other.csv.gz --model mine.toml --schedule still=60,drive=300,seed=1\n"
      "  zerorate characterize rest.csv --axis z --order 0.5 --json -\n"
      "  zerorate characterize monday.csv --with tuesday.csv friday.csv --model-out mine.toml\n"
      "The JSON is described in docs/reference/characterization-format.md.");
  return {command, [options] { return run_characterize(*options); }};
}

}  // namespace zerorate::cli

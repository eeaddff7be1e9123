#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/model_file.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/output_options.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/diagnose/truncation_cause.hpp"
#include "host_tools/lib/identify/characterization_report.hpp"
#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/identify/filter_noise.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"
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
  std::string kalibr;
  std::string gtsam;
  std::string matlab;
  std::string robot_localization;
  std::string allan_csv;
  bool is_verbose = false;

  /// Whether the standard output is free for text.
  [[nodiscard]] bool prints_text() const {
    const std::array<const std::string*, 6> files{
        &kalibr, &gtsam, &matlab, &robot_localization, &allan_csv, &model_out};
    return outputs.prints_text() &&
           std::ranges::none_of(files, [](const std::string* file) { return *file == "-"; });
  }
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

/// Further recordings, read as the first one was. Throws recording::DataError where one of the axes
/// did not measure.
/// @param doubts  gets what speaks against rest and is not certain
std::vector<identify::RestSamples> read_others(const CharacterizeOptions& options,
                                               const std::vector<std::size_t>& axes,
                                               std::vector<std::string>& doubts) {
  std::vector<identify::RestSamples> others;
  for (const std::string& name : options.others) {
    InputFlags input = options.input;
    input.recording = name;
    recording::Reader reader{to_input(input)};
    identify::RestSamples samples =
        identify::read_rest(reader, identify::rest_source(options.still_from));
    std::vector<std::size_t> measured = axes;
    for (std::string& doubt : identify::require_rest(
             samples, identify::AcceptedDoubts{options.input.accept}, measured)) {
      if (measured != axes) throw recording::DataError(fmt::format("{}: {}", name, doubt));
      doubts.push_back(name + ": " + std::move(doubt));
    }
    others.push_back(std::move(samples));
  }
  return others;
}

identify::Characterization run_identification(const CharacterizeOptions& options) {
  const std::optional<double> order = parse_order(options.order);
  recording::Reader reader{to_input(options.input)};
  auto axes = identify::axes_called(options.axis, reader.columns().axis_count);
  identify::RestOptions rest;
  ProgressBar progress{"characterizing"};
  // Reading takes about half the time.
  rest.on_progress = [&](std::optional<double> share) {
    progress.update(share ? std::optional{0.5 * *share} : std::nullopt);
  };
  const identify::RestSamples samples =
      identify::read_rest(reader, identify::rest_source(options.still_from), rest);
  const identify::AcceptedDoubts accepted{options.input.accept};
  std::vector<std::string> doubts = identify::require_rest(samples, accepted, axes);
  std::ranges::move(diagnose::remarks_on_truncation(samples, accepted), std::back_inserter(doubts));
  const identify::CharacterizeOptions settings{
      .recording = file_name(options.input.recording),
      .axes = axes,
      .order = order,
      .on_progress = [&](double share) { progress.update(0.5 + 0.5 * share); }};
  identify::Characterization result = identify::characterize(samples, settings);
  if (options.still_from == "gyro") identify::require_noise_of_rest(result);
  result.doubts = std::move(doubts);
  if (options.others.empty()) return result;
  const std::vector<identify::RestSamples> others = read_others(options, axes, result.doubts);
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

constexpr std::size_t kFigureWidth = 28;

void print_line(std::string_view what, const std::string& figure, std::string_view remark) {
  const std::string_view gap = figure.size() < kFigureWidth ? "" : " ";
  fmt::print("  {:<24} {:<{}}{} {}\n", what, figure, kFigureWidth, gap, remark);
}

void print_flicker(const identify::InnovationsFit& fit) {
  if (!fit.flicker) {
    print_line("flicker noise", "not detectable", fmt::format("p = {:.2g}", fit.p_value));
    return;
  }
  print_line("flicker noise at 1 rad/s",
             identify::text(fit.flicker->bias_instability_rad_s, kDphPerRadS),
             "deg/h, with the order below; the B of IEEE Std 952 has d = 1/2");
  print_line("order d", identify::text(fit.flicker->order),
             identify::explain(fit.flicker->order_source));
}

void print_axis(const identify::AxisCharacterization& axis, bool is_verbose) {
  const auto& arw = axis.fit.angle_random_walk_rad_per_sqrt_s;
  fmt::print("\naxis {}\n", axis.axis);
  print_line("angle random walk N", identify::text(arw, kDegPerRad),
             "deg/s/sqrt(Hz), of the white noise alone; a rate noise density over sqrt(2)");
  print_line("", identify::text(arw, 60.0 * kDegPerRad), "deg/sqrt(h)");
  print_flicker(axis.fit);
  if (is_verbose && axis.local_whittle_order) {
    print_line("order by local Whittle",
               fmt::format("{:.2f} +- {:.2f}", axis.local_whittle_order->value,
                           axis.local_whittle_order->standard_error),
               "without a model; white noise biases it downwards");
  }
  if (!axis.allan.empty()) print_line("Allan deviation floor", identify::floor_text(axis), "deg/h");
  for (const std::string& remark : axis.remarks) fmt::print("  note: {}\n", remark);
}

/// The table that papers and other tools have: white noise, 1/f noise and a random walk.
void print_coefficients(const identify::Characterization& result) {
  fmt::print("\nN, B and K of IEEE Std 952 (white noise, 1/f noise and random walk together)\n");
  fmt::print("  {:<5} {:<27} {:<27} {}\n", "axis", "N [deg/sqrt(h)]", "B [deg/h]",
             "K [deg/h/sqrt(h)]");
  for (const auto& axis : result.axes) {
    const identify::NoiseCoefficients& one = axis.coefficients;
    fmt::print("  {:<5} {:<27} {:<27} {}\n", axis.axis,
               identify::text(one.angle_random_walk_rad_per_sqrt_s, units::kDegRtHPerRadRtS),
               identify::text(one.bias_instability_rad_s, kDphPerRadS),
               identify::text(one.rate_random_walk_rad_s_per_sqrt_s, units::kDphRtHPerRadSRtS));
  }
}

/// N and K of the files for programs that have no flicker noise.
void print_filter_noise(const identify::Characterization& result) {
  std::vector<std::vector<std::string>> rows{{"  axis", "N [deg/sqrt(h)]", "K [deg/h/sqrt(h)]"}};
  for (const auto& axis : result.axes) {
    const auto& pair = axis.coefficients.without_flicker;
    if (!pair) continue;
    rows.push_back(
        {"  " + axis.axis,
         identify::text(pair->angle_random_walk_rad_per_sqrt_s, units::kDegRtHPerRadRtS),
         identify::text(pair->rate_random_walk_rad_s_per_sqrt_s, units::kDphRtHPerRadSRtS)});
  }
  if (rows.size() < 2) return;
  fmt::print(
      "\nWithout 1/f noise, as --kalibr, --gtsam, --matlab and --robot-localization have it; K "
      "is all of the slow noise\n{}",
      aligned(rows));
}

void print_sameness(const identify::Characterization& result, const identify::Sameness& axis) {
  fmt::print("\naxis {}, {} recordings: {} (p = {:.2g})\n", axis.axis, axis.alone.size(),
             axis.holds() ? "one parameter set serves all"
                          : "the noise has changed, one parameter set does not serve all, and "
                            "the model is that of the first",
             axis.p_value);
  std::vector<std::vector<std::string>> rows{
      {"  recording", "N [deg/s/sqrt(Hz)]", "flicker noise at 1 rad/s [deg/h]"}};
  const auto add = [&](const std::string& name, const identify::InnovationsFit& fit) {
    rows.push_back({"  " + name, identify::text(fit.angle_random_walk_rad_per_sqrt_s, kDegPerRad),
                    fit.flicker ? identify::text(fit.flicker->bias_instability_rad_s, kDphPerRadS)
                                : std::string("not detectable")});
  };
  add(result.recording, axis.alone.front());
  for (std::size_t i = 1; i < axis.alone.size(); ++i) {
    add(result.further_recordings[i - 1], axis.alone[i]);
  }
  add("together", axis.together);
  fmt::print("{}", aligned(rows));
}

void print_characterization(const identify::Characterization& result, bool is_verbose) {
  fmt::print("{}: {} samples every {:.6g} s, {:.0f} s at rest; filter ticks of {:.6g} s\n",
             result.recording, result.rows, static_cast<double>(result.sample_period.ns()) * 1e-9,
             result.rest_s, static_cast<double>(result.tick.ns()) * 1e-9);
  print_findings(result.findings);
  if (result.rows_moving > 0) {
    fmt::print("  note: {} rows left out because the vehicle moved\n", result.rows_moving);
  }
  if (result.rows_wild > 0) {
    fmt::print("  note: the first {} rows left out: the gyro did not measure yet\n",
               result.rows_wild);
  }
  if (result.rows_repeated > 0) {
    fmt::print("  note: {} rows left out that repeat the one before: read faster than measured\n",
               result.rows_repeated);
  }
  if (result.rows_outlying > 0) {
    fmt::print("  note: {} sample{} left out, far from those around them: no noise of a gyro\n",
               result.rows_outlying, result.rows_outlying == 1 ? "" : "s");
  }
  fmt::print("Figures in brackets are 95 % intervals.\n");
  for (const auto& axis : result.axes) print_axis(axis, is_verbose);
  print_coefficients(result);
  print_filter_noise(result);
  for (const auto& sameness : result.sameness) print_sameness(result, sameness);
}

/// A drift beyond any flicker noise is a finding: the model does not describe the sensor.
ExitCode judge(const identify::Characterization& result) {
  const bool drifts = std::ranges::any_of(result.axes, [](const auto& axis) {
    return axis.fit.flicker && axis.fit.flicker->order_source == identify::OrderSource::limit;
  });
  return drifts ? finding : success;
}

void write_filter_noise(const CharacterizeOptions& options, const identify::FilterNoise& noise) {
  const auto write = [&](const std::string& file,
                         std::string (*text)(const identify::FilterNoise&)) {
    if (!file.empty()) write_text(file, text(noise));
  };
  write(options.kalibr, identify::kalibr_yaml);
  write(options.gtsam, identify::gtsam_python);
  write(options.matlab, identify::matlab_function);
  write(options.robot_localization, identify::robot_localization_yaml);
}

ExitCode run_characterize(const CharacterizeOptions& options) {
  const identify::Characterization result = run_identification(options);
  if (!options.outputs.report.empty()) {
    identify::make_report(
        result, "zerorate " ZERORATE_VERSION ", zerorate characterize " + result.recording)
        .write(options.outputs.report);
  }
  if (!options.outputs.json.empty()) write_text(options.outputs.json, identify::to_json(result));
  write_filter_noise(options, identify::FilterNoise::of(result));
  if (!options.allan_csv.empty()) write_text(options.allan_csv, identify::allan_csv(result));
  if (options.prints_text()) {
    print_doubt_of_rows(result.findings);
    for (const std::string& doubt : result.doubts) fmt::print("{}\n", wrapped("note: " + doubt));
    print_characterization(result, options.is_verbose);
  }
  if (!options.model_out.empty()) {
    const auto& axis = identify::middle_axis(result);
    const auto same = std::ranges::find(result.sameness, axis.axis, &identify::Sameness::axis);
    const bool is_of_all = same != result.sameness.end() && same->holds();
    write_text(options.model_out, model::format_model(is_of_all ? same->model : axis.model));
    if (options.prints_text()) {
      fmt::print("\n{}: the model of axis {}{}{}\n", options.model_out, axis.axis,
                 result.axes.size() > 1 ? ", the one with the median slow noise" : "",
                 is_of_all ? ", fitted to all recordings" : "");
    }
  }
  return result.doubts.empty() ? judge(result) : finding;
}

}  // namespace

Command add_characterize(CLI::App& app) {
  auto* command =
      app.add_subcommand("characterize", "Identify a sensor's noise from a recording at rest");
  const auto options = std::make_shared<CharacterizeOptions>();
  add_input_options(*command, options->input);
  add_rest_options(*command, options->still_from);
  add_axis_option(*command, options->axis);
  command
      ->add_option("--order", options->order,
                   "order d of the flicker noise: free (estimated where the recording is long "
                   "enough, else 1/2) or a number from 0.05 to 0.95")
      ->capture_default_str();
  command->add_option("--with", options->others,
                      "further recordings of the same sensor: tests whether one parameter set "
                      "serves all (a test that errs for 1 % of unchanged sensors); if so "
                      "--model-out is fitted to all");
  add_output_options(*command, options->outputs);
  command->add_option("--model-out", options->model_out,
                      "write the sensor model for 'zerorate replay --model'; with several axes, "
                      "that of the axis with the median slow noise");
  command->add_option("--kalibr", options->kalibr,
                      "write N and K as the imu.yaml of Kalibr and allan_variance_ros, fitted "
                      "without flicker noise");
  command->add_option("--gtsam", options->gtsam,
                      "write N^2 and K^2 as Python that sets a PreintegrationCombinedParams");
  command->add_option("--matlab", options->matlab,
                      "write a MATLAB function that gives gyroparams of imuSensor");
  command->add_option("--robot-localization", options->robot_localization,
                      "write the covariance of sensor_msgs/Imu that robot_localization reads");
  command->add_option("--allan-csv", options->allan_csv,
                      "write the Allan deviations with their intervals as comma-separated values");
  command->add_flag("--verbose", options->is_verbose, "print the order by local Whittle, too");
  command->footer(
      "Rows in which the vehicle moves, by an odometer or still column, are left out.\n"
      "N, B and K at the end are those of a sensor with white noise, 1/f noise and a random walk;\n"
      "the model of an axis has a free order d instead of the random walk.\n"
      "Exit codes: 0 done (also if no flicker noise is detectable), 1 the bias drifts more than\n"
      "flicker noise can, or the recording may not be one at rest, 2 wrong usage, 3 data that "
      "cannot\n"
      "be used, as of a sensor that was turned.\n"
      "Examples:\n"
      "  zerorate characterize rest.csv.gz --report noise.html --model-out mine.toml\n"
      "  zerorate replay other.csv.gz --model mine.toml --schedule still=60,drive=300,seed=1\n"
      "  zerorate characterize rest.csv --axis z --order 0.5 --json -\n"
      "  zerorate characterize rest.csv --kalibr imu.yaml --allan-csv allan.csv\n"
      "  zerorate characterize monday.csv --with tuesday.csv friday.csv --model-out mine.toml\n"
      "The JSON is described in docs/reference/characterization-format.md.");
  return {command, [options] { return run_characterize(*options); }};
}

}  // namespace zerorate::cli

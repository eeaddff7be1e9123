#include "host_tools/cli/replay_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "firmware/model/sensor_model.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/reference_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/evaluate/learnt_model.hpp"
#include "host_tools/lib/evaluate/replay_json.hpp"
#include "host_tools/lib/evaluate/true_drives_report.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::cli {
namespace {

using units::kDegPerRad;
using units::kRadPerDeg;

core::Duration seconds(double value, const char* option) {
  if (!(value >= 0.0) || value > 1e6) {
    throw std::invalid_argument(
        fmt::format("{}: expected seconds from 0 to 1e6, found {}", option, value));
  }
  return core::Duration::nanoseconds(std::llround(value * 1e9));
}

model::SensorModel chosen_model(const ReplayFlags& flags) {
  if (flags.arw_dps_rt_hz.has_value() != flags.bias_instability_dph.has_value()) {
    throw std::invalid_argument("--arw and --bias-instability belong together: give both");
  }
  if (!flags.arw_dps_rt_hz) return model::load_model(flags.model);
  // IEEE Std 952: the floor of the Allan deviation is sqrt(2 ln 2 / pi) B.
  const double floor_per_b = std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi);
  model::SensorModel model;
  model.name = "from the command line";
  model.white.angle_random_walk_rad_per_sqrt_s = *flags.arw_dps_rt_hz * kRadPerDeg;
  model.flicker = model::Flicker{.bias_instability_rad_s = *flags.bias_instability_dph / 3600.0 *
                                                           kRadPerDeg / floor_per_b};
  model::validate(model);
  return model;
}

std::vector<std::string> chip_names() {
  std::vector<std::string> names;
  for (const auto& chip : evaluate::simulated_chips()) names.emplace_back(chip.name);
  return names;
}

app::Predictor predictor_called(const std::string& name) {
  for (const app::Predictor predictor : evaluate::kAllPredictors) {
    if (evaluate::name(predictor) == name) return predictor;
  }
  throw std::invalid_argument("--predictor: expected kalman, moving_average or calibration_mean");
}

constexpr std::array<const char*, 3> kSources{"odometer", "gyro", "odometer-alone"};

core::StandstillSource source_called(const std::string& name) {
  return static_cast<core::StandstillSource>(std::ranges::find(kSources, name) - kSources.begin());
}

constexpr std::array<const char*, 6> kUpAxes{"x", "y", "z", "-x", "-y", "-z"};

core::UpAxis up_axis_called(const std::string& name) {
  const auto found = std::ranges::find(kUpAxes, name) - kUpAxes.begin();
  return {.axis = static_cast<std::uint8_t>(found % 3), .points_down = found >= 3};
}

std::string counted(std::uint64_t samples) {
  return fmt::format("{} sample{}", samples, samples == 1 ? "" : "s");
}

void print_notes(const evaluate::ReplayResult& result) {
  print_findings(result.findings);
  if (result.samples_refused > 0) {
    fmt::print("  note: the node refused {}\n", counted(result.samples_refused));
  }
  if (result.samples_saturated > 0) {
    fmt::print("  note: full scale in {}\n", counted(result.samples_saturated));
  }
  if (result.samples_doubted > 0) {
    fmt::print("  note: {} came while the gate held back a measurement\n",
               counted(result.samples_doubted));
  }
  if (result.samples_without_temperature > 0) {
    fmt::print("  note: {} came without the temperature that the model follows\n",
               counted(result.samples_without_temperature));
  }
  if (result.samples_without_acceleration > 0) {
    fmt::print("  note: {} came without the acceleration that the model follows\n",
               counted(result.samples_without_acceleration));
  }
  if (result.samples_frozen > 0) {
    fmt::print(
        "  note: in {}, from {:.6g} s after the first row on, an axis no longer measures: it "
        "repeats "
        "itself. There is no rate\n",
        counted(result.samples_frozen), result.first_frozen_s);
  }
  if (result.samples_disagreeing > 0) {
    // With a schedule the recording is one at rest.
    fmt::print("  note: in {} gyro and odometer contradict each other{}\n",
               counted(result.samples_disagreeing),
               result.truth_known ? ": was the sensor at rest all the time?" : "");
  }
  if (result.samples_inconsistent > 0) {
    fmt::print(
        "  note: the model does not fit this sensor, by {} of {} samples, from {:.6g} s on; "
        "zerorate "
        "characterize fits one to a recording at rest, zerorate diagnose finds what it lacks\n",
        result.samples_inconsistent, result.rows, result.first_inconsistent_s);
  }
}

void print_learnt(const evaluate::ReplayResult& result, const std::vector<std::size_t>& axes) {
  if (!result.learnt) return;
  fmt::print(
      "\nNoise model learnt from the stops, with 95 % intervals (evidence: as many stops of full "
      "weight)\n{:<4} {:>9} {:>25} {:>25} {:>31}\n",
      "axis", "evidence", "order d", "B deg/h", "N deg/s/sqrt(Hz)");
  for (const std::size_t axis : axes) {
    const auto learnt = evaluate::learnt_model((*result.learnt)[axis], result.mesh);
    fmt::print("{:<4} {:>9.1f} {:>25} {:>25} {:>31}\n", evaluate::axis_name(result, axis),
               learnt.stops, evaluate::in_words(learnt.order),
               evaluate::in_words(learnt.bias_instability_dph),
               evaluate::in_words(learnt.angle_random_walk_dps_per_sqrt_hz));
    const std::string edge = evaluate::edge_in_words(learnt, result.mesh);
    if (!edge.empty()) fmt::print("  note: {}\n", edge);
  }
}

void print_scores(const evaluate::ReplayResult& result, const std::vector<std::size_t>& axes) {
  fmt::print("\n{:<4} {:<17} {:>7} {:>15} {:>22} {:>12} {:>10} {:>11} {:>10}\n", "axis",
             "predictor", "drives", "drift deg rms", "ratio to CM [95 %]", "coverage 95",
             "sigma/rms", "RSSE deg/s", "IE deg");
  for (const std::size_t axis : axes) {
    const auto& baseline = result.scores[axis].back();
    for (const app::Predictor predictor : evaluate::kAllPredictors) {
      const auto& scores = result.scores[axis][static_cast<std::size_t>(predictor)];
      fmt::print("{:<4} {:<17} {:>7} {:>15} {:>22} {:>12} {:>10} {:>11} {:>10}\n",
                 evaluate::axis_name(result, axis), evaluate::name(predictor), scores.drives(),
                 cell(scores.heading_drift_rms_rad() * kDegPerRad, 4),
                 evaluate::in_words(evaluate::drift_ratio(scores, baseline)),
                 cell(scores.coverage95(), 3), cell(scores.sigma_over_rms(), 2),
                 cell(scores.mean_rsse_rad_s() * kDegPerRad, 3),
                 cell(scores.mean_integrated_rad() * kDegPerRad, 4));
    }
  }
}

void print_stop_scores(const evaluate::ReplayResult& result, const std::vector<std::size_t>& axes) {
  if (result.stop_scores[axes.front()].front().stops() == 0) return;
  fmt::print(
      "\nBias predicted for each stop, less what its first {:.3g} s then measured (sigma: as "
      "predicted)\n{:<4} {:<17} {:>7} {:>16} {:>13} {:>12}\n",
      result.stop_scores[axes.front()].front().measured_s(), "axis", "predictor", "stops",
      "error deg/h rms", "error sigmas", "coverage 95");
  for (const std::size_t axis : axes) {
    for (const app::Predictor predictor : evaluate::kAllPredictors) {
      const auto& scores = result.stop_scores[axis][static_cast<std::size_t>(predictor)];
      fmt::print("{:<4} {:<17} {:>7} {:>16} {:>13} {:>12}\n", evaluate::axis_name(result, axis),
                 evaluate::name(predictor), scores.stops(),
                 cell(scores.error_rms_rad_s() * units::kDphPerRadS, 2),
                 cell(scores.error_rms_sigmas(), 2), cell(scores.coverage95(), 3));
    }
  }
}

}  // namespace

void add_replay_flags(CLI::App& app, ReplayFlags& flags) {
  app.add_option(
         "--axis", flags.axis,
         "x, y, z, or all, the vertical axis first (by the reference, else z); default: of a "
         "drive the vertical axis alone, with --schedule all")
      ->check(CLI::IsMember({"x", "y", "z", "all"}));
  auto* model = app.add_option("--model", flags.model,
                               "sensor model: a TOML file or a name from 'zerorate model list'");
  model->capture_default_str();
  flags.model_option = model;
  app.add_option(
         "--arw", flags.arw_dps_rt_hz,
         "angle random walk [deg/s/sqrt(Hz)], two-sided as in IEEE Std 952, instead of --model")
      ->excludes(model);
  app.add_option("--bias-instability", flags.bias_instability_dph,
                 "floor of the Allan deviation [deg/h], instead of --model")
      ->excludes(model);
  app.add_option("--schedule", flags.schedule,
                 "stops and drives for a recording at rest, exponential lengths around means in "
                 "seconds: still=60,drive=300,seed=1");
  app.add_option("--through", flags.through,
                 "chip: by a simulated chip and its driver; source: straight into the node")
      ->check(CLI::IsMember({"chip", "source"}))
      ->capture_default_str();
  app.add_option("--chip", flags.chip, "the chip of --through chip; default lsm6dso")
      ->check(CLI::IsMember(chip_names()));
  app.add_option("--predictor", flags.predictor,
                 "predictor of the published rate: kalman, moving_average, calibration_mean")
      ->capture_default_str();
  app.add_option(
         "--sample-rate", flags.sample_rate_hz,
         "nominal rate of the samples [Hz], as a node has it from its chip; default: by the "
         "recording's mean interval")
      ->check(CLI::PositiveNumber);
  app.add_option(
      "--filter-rate", flags.filter_rate_hz,
      "ticks of the predictors per second [Hz]; default 2, or the sensor's rate if lower");
  app.add_option("--settle", flags.settle_s,
                 "rest after the last odometer pulse before a stop counts [s]")
      ->capture_default_str();
  app.add_option("--hold-back", flags.hold_back_s,
                 "how long a sample waits for a late pulse before it counts [s]")
      ->capture_default_str();
  app.add_option("--still-from", flags.still_from,
                 "source of rest: odometer (and the calm in its stops), gyro (its calm "
                 "alone, as "
                 "without an odometer) or odometer-alone (whatever the gyro shows)")
      ->check(CLI::IsMember(std::vector<std::string>(kSources.begin(), kSources.end())))
      ->capture_default_str();
  app.add_flag("--trust-model", flags.trusts_model,
               "take the strengths of the noise from the model; without it they are learnt from "
               "the stops");
  app.add_option("--latitude", flags.latitude_deg,
                 "latitude [deg], north positive: the Earth's rotation is taken out of the "
                 "bias; default: not known, it stays there")
      ->check(CLI::Range(-90.0, 90.0));
  app.add_option("--up", flags.up,
                 "axis of the sensor that points up: its rate and heading are those about the "
                 "vertical; default: not known, z for --latitude, and that of the reference where "
                 "its headings teach")
      ->check(CLI::IsMember(std::vector<std::string>(kUpAxes.begin(), kUpAxes.end())));
}

evaluate::ReplayOptions to_replay_options(const ReplayFlags& flags) {
  evaluate::ReplayOptions options;
  options.model = chosen_model(flags);
  options.is_model_chosen =
      flags.arw_dps_rt_hz || (flags.model_option != nullptr && flags.model_option->count() > 0);
  options.sample_rate_hz = flags.sample_rate_hz;
  options.filter_rate_hz = flags.filter_rate_hz;
  if (!flags.schedule.empty()) options.schedule = evaluate::parse_schedule(flags.schedule);
  options.through = flags.through == "chip" ? evaluate::Through::chip : evaluate::Through::source;
  if (flags.chip) {
    if (options.through != evaluate::Through::chip) {
      throw std::invalid_argument("--chip needs --through chip");
    }
    options.chip = *flags.chip;
  }
  options.published = predictor_called(flags.predictor);
  options.standstill = {.settle = seconds(flags.settle_s, "--settle"),
                        .hold_back = seconds(flags.hold_back_s, "--hold-back"),
                        .source = source_called(flags.still_from)};
  options.learns_noise = !flags.trusts_model;
  if (!flags.up.empty()) options.up = up_axis_called(flags.up);
  if (flags.latitude_deg) {
    options.earth = core::earth_rate(static_cast<float>(*flags.latitude_deg),
                                     options.up.value_or(core::UpAxis{}));
  }
  return options;
}

std::vector<std::size_t> shown_axes(const ReplayFlags& flags, std::size_t axis_count,
                                    const std::optional<truth::Truth>& truth) {
  std::vector<std::size_t> axes = scored_axes(flags, axis_count);
  if (axes.size() == 1) return axes;
  const std::size_t vertical = truth ? truth->vertical.axis : axis_count - 1;
  const bool is_drive = flags.schedule.empty();
  if (is_drive && flags.axis.empty()) return {vertical};
  std::rotate(axes.begin(), axes.begin() + static_cast<std::ptrdiff_t>(vertical), axes.end());
  return axes;
}

std::vector<std::size_t> scored_axes(const ReplayFlags& flags, std::size_t axis_count) {
  return identify::axes_called(flags.axis.empty() ? "all" : flags.axis, axis_count);
}

void print_what_is_not_shown(const ReplayFlags& flags, const evaluate::ReplayResult& result,
                             const std::vector<std::size_t>& axes) {
  if (!flags.axis.empty() || axes.size() == result.axis_count) return;
  fmt::print("axis {} is the vertical one{}; --axis all shows the others too\n",
             evaluate::axis_name(result, axes.front()),
             result.true_drives ? ", by the reference" : " unless --axis names another");
}

void print_doubt_of_rows(const recording::Findings& findings) {
  const std::string doubt = recording::doubt_of_rows(findings);
  if (!doubt.empty()) fmt::print("note: {}\n", doubt);
}

/// "; the longest of 31600 s ends in line 6602"
std::string longest_interval(const recording::Findings& findings) {
  return fmt::format("; the longest of {} s ends in line {}",
                     units::in_figures(units::seconds(findings.longest_interval_ns())),
                     findings.longest_interval_line());
}

void print_findings(const recording::Findings& findings) {
  if (!findings.program().empty()) {
    fmt::print("  note: read as a recording of {}\n", findings.program());
  }
  for (std::size_t i = 0; i < recording::kFindingCount; ++i) {
    const auto finding = static_cast<recording::Finding>(i);
    if (const auto count = findings.count(finding); count > 0) {
      fmt::print("  note: {} in {} row{}, first in line {}{}\n", recording::description(finding),
                 count, count == 1 ? "" : "s", findings.first_line(finding),
                 finding == recording::Finding::gap ? longest_interval(findings) : "");
    }
  }
  const std::string doubt = recording::doubt_of_acceleration(findings);
  if (!doubt.empty()) fmt::print("  note: {}\n", doubt);
}

void print_result(const evaluate::ReplayResult& result, const std::vector<std::size_t>& axes) {
  print_doubt_of_rows(result.findings);
  fmt::print("model: {}\n", result.model);
  if (!result.is_model_chosen) {
    fmt::print(
        "  note: no --model was given, so this is the default; of another sensor 'zerorate "
        "characterize' makes its model, and 'zerorate model list' names those of data sheets\n");
  }
  if (!result.states_scale_factor && !result.truth_known) {
    fmt::print(
        "  note: the model states no tolerance of the scale factor ([scale_factor]), so the turn "
        "is published with {:g} %\n",
        100.0 * model::ScaleFactor{}.sigma);
  }
  for (const std::string& doubt : result.rest_doubts) fmt::print("  note: {}\n", doubt);
  fmt::print("{} samples every {:.6g} s, filter ticks of {:.6g} s\n", result.rows,
             static_cast<double>(result.sample_period.ns()) * 1e-9,
             static_cast<double>(result.filter_tick.ns()) * 1e-9);
  print_notes(result);
  if (result.true_drives) print_true_drives(*result.true_drives, result.axis_count);
  if (result.learnt_motion) print_learnt_motion(*result.learnt_motion);
  if (result.truth_known) {
    print_scores(result, axes);
  } else if (!result.true_drives) {
    fmt::print(
        "  note: the true rate is not known, so headings are not scored; --schedule means that the "
        "sensor was at rest\n");
  }
  print_stop_scores(result, axes);
  print_learnt(result, axes);
}

}  // namespace zerorate::cli

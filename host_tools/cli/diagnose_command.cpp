#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "firmware/model/model_file.hpp"
#include "host_tools/cli/commands.hpp"
#include "host_tools/cli/diagnosis_text.hpp"
#include "host_tools/cli/input_options.hpp"
#include "host_tools/cli/output_options.hpp"
#include "host_tools/cli/reference_options.hpp"
#include "host_tools/cli/replay_options.hpp"
#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/diagnose/drive/drive_diagnosis.hpp"
#include "host_tools/lib/diagnose/presentation/presentation.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/odometry/odometer_findings.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::cli {
namespace {

using diagnose::Diagnosis;
struct DiagnoseOptions {
  InputFlags input_flags;
  recording::Input recording;  ///< filled by input_flags
  std::string axis = "all";
  std::string still_from = "odometer";
  std::string model;
  std::string model_out;
  double holdout = 0.3;
  bool is_verbose = false;
  OutputOptions outputs;
};

/// Last part of its path, the source that reports and models name.
std::string file_name(const recording::Input& recording) {
  return recording.path.filename().string();
}

using odometry::OdometerDiagnosis;

void print_note(const DiagnoseOptions& options, const std::string& note) {
  if (options.outputs.prints_text()) fmt::print("  note: {}\n", note);
}

/// Faults of the odometer; nullopt where the recording has no reference to judge it by.
std::optional<OdometerDiagnosis> examine_odometer(const DiagnoseOptions& options) {
  if (!std::filesystem::is_regular_file(options.recording.path)) return std::nullopt;
  const recording::Columns columns = recording::Reader{options.recording}.columns();
  if (!columns.ref_speed || !columns.odometer) return std::nullopt;
  try {
    const odometry::SpeedRecord record = odometry::read_speed_record(options.recording.path);
    OdometerDiagnosis odometer;
    odometer.findings = odometry::find_odometer_faults(record, odometry::measure_odometer(record));
    odometer.configuration = odometry::configuration_of(record, odometer.findings);
    return odometer;
  } catch (const recording::DataError& reason) {
    print_note(options, fmt::format("the odometer was not examined: {}", reason.what()));
    return std::nullopt;
  }
}

/// Findings of the gyro alone about an odometer that is silent while the vehicle moves.
std::vector<odometry::OdometerFinding> motion_by_gyro(const identify::MotionAtRest& motion) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto single = [&](double value) { return odometry::BootstrapFigure{value, kNone, kNone}; };
  const auto turning = [&](double share) {
    return single(statistics::quantile_of_sorted(motion.turning_rad_s, share) * units::kDegPerRad);
  };
  return {
      {.name = "motion_in_stops",
       .sentence = fmt::format("In {:.1f} % of the time in which the odometer reports that it "
                               "stands, the gyro shows motion.",
                               100.0 * motion.share()),
       .figures = {{"share", single(motion.share())},
                   {"turning_median_dps", turning(0.5)},
                   {"turning_95_percent_dps", turning(0.95)}}},
      {.name = "odometer_dead_band",
       .sentence = fmt::format("In {} of {} stops it is silent while the vehicle moves; its "
                               "speed needs a ref_speed_mps column.",
                               motion.stops_with_motion, motion.stops),
       .figures = {{"stops_with_motion", single(static_cast<double>(motion.stops_with_motion))}}}};
}

/// Leaves out the motion in the stops of an odometer that is known or seen to be silent too early,
/// and adds the evidence of the gyro where there is no reference speed.
void keep_calm(identify::RestSamples& samples, std::optional<OdometerDiagnosis>& odometer) {
  const identify::MotionAtRest motion = identify::find_motion(samples);
  const bool is_told = odometer && odometer->find("motion_in_stops") != nullptr;
  if (!is_told && (odometer || !motion.is_usual())) return;
  if (!odometer) odometer = OdometerDiagnosis{.findings = motion_by_gyro(motion)};
  identify::leave_out_motion(samples, motion);
}

evaluate::TrueScore true_score(const DiagnoseOptions& options, const truth::Truth& truth,
                               const model::SensorModel& model,
                               core::StandstillSource standstill_source) {
  recording::Reader reader{options.recording};
  evaluate::ReplayOptions replay{.model = model};
  replay.standstill.source = standstill_source;
  const auto result = evaluate::replay(reader, replay, {.truth = truth});
  return result.true_drives->score(replay.published);
}

/// Heading errors with and without the judgement of the calm; nullopt without a true heading.
std::optional<odometry::HeadingGain> measure_gain(const DiagnoseOptions& options,
                                                  const std::vector<Diagnosis>& diagnoses) {
  try {
    const std::optional<truth::Truth> truth = read_truth(options.recording, {});
    if (!truth || !truth->obstacle.empty()) return std::nullopt;
    const std::string vertical{"xyz"[truth->vertical.axis]};
    const auto found = std::ranges::find(diagnoses, vertical, &Diagnosis::axis);
    const Diagnosis& diagnosis = found == diagnoses.end() ? diagnoses.front() : *found;
    const auto score = [&](core::StandstillSource source) {
      return true_score(options, *truth, diagnosis.base_model, source);
    };
    const auto every_stop = score(core::StandstillSource::odometer_alone);
    const auto calm = score(core::StandstillSource::odometer);
    if (calm.drives == 0) return std::nullopt;
    return odometry::HeadingGain{.drives = calm.drives,
                                 .every_stop_rms_rad = every_stop.rms_rad,
                                 .every_stop_coverage95 = every_stop.coverage95,
                                 .calm_rms_rad = calm.rms_rad,
                                 .calm_coverage95 = calm.coverage95};
  } catch (const recording::DataError& reason) {
    print_note(options, fmt::format("the gain in heading was not measured: {}", reason.what()));
    return std::nullopt;
  }
}

/// @param doubts  set to what speaks against rest and is not certain
std::vector<Diagnosis> run_diagnosis(const DiagnoseOptions& options,
                                     std::optional<OdometerDiagnosis>& odometer,
                                     std::vector<std::string>& doubts) {
  diagnose::DiagnoseOptions diagnose_options{.recording = file_name(options.recording),
                                             .holdout = options.holdout};
  if (!options.model.empty()) diagnose_options.base_model = model::load_model(options.model);
  recording::Reader reader{options.recording};
  auto axes = identify::axes_called(options.axis, reader.columns().axis_count);
  ProgressBar progress{"diagnosing"};
  // Reading takes about a tenth of the time.
  constexpr double kReading = 0.1;
  identify::RestOptions rest;
  rest.on_progress = [&](std::optional<double> share) {
    progress.update(share ? std::optional{kReading * *share} : std::nullopt);
  };
  const core::StandstillSource source = identify::rest_source(options.still_from);
  identify::RestSamples samples = identify::read_rest(reader, source, rest);
  if (source == core::StandstillSource::odometer && reader.columns().odometer) {
    keep_calm(samples, odometer);
  }
  const identify::AcceptedDoubts accepted{options.recording.accepted};
  doubts = identify::require_rest(samples, accepted, axes);
  if (std::string unused = recording::doubt_of_rows(samples.findings); !unused.empty())
    doubts.insert(doubts.begin(), std::move(unused));
  for (const std::string& doubt : doubts) print_note(options, doubt);
  if (samples.wild > 0) {
    print_note(options, fmt::format("the first {} samples left out: the gyro did not measure yet",
                                    samples.wild));
  }
  std::vector<diagnose::Record> records = diagnose::records_of(samples, axes, accepted);
  diagnose_options.on_progress = [&](double share) {
    progress.update(kReading + (1.0 - kReading) * share);
  };
  diagnose_options.on_left_out = [&](const std::string& axis, const std::string& reason) {
    print_note(options, fmt::format("axis {} was not diagnosed: {}", axis, reason));
  };
  return diagnose::diagnose(std::move(records), diagnose_options);
}

/// The drives by the reference's heading, if there is one; their causes that pay are added to the
/// extended model of the vertical axis.
std::optional<diagnose::DriveDiagnosis> examine_drives(const DiagnoseOptions& options,
                                                       std::vector<Diagnosis>& diagnoses) {
  if (!std::filesystem::is_regular_file(options.recording.path)) return std::nullopt;
  recording::Reader reader{options.recording};
  const recording::Columns& columns = reader.columns();
  if (!columns.ref_speed || (!columns.ref_heading && !columns.ref_rate)) return std::nullopt;
  try {
    const truth::Track track = truth::read_track(reader);
    const truth::Truth truth = truth::find_truth(track, {});
    const std::string vertical{"xyz"[truth.vertical.axis]};
    const auto found = std::ranges::find(diagnoses, vertical, &Diagnosis::axis);
    Diagnosis& diagnosis = found == diagnoses.end() ? diagnoses.front() : *found;
    return diagnose::diagnose_drives(
        diagnose::read_drive_record(options.recording, track, truth, diagnosis.base_model),
        diagnosis.extended_model);
  } catch (const recording::DataError& reason) {
    print_note(options, fmt::format("the drives were not diagnosed: {}", reason.what()));
    return std::nullopt;
  }
}

/// FILE for a single axis; of several, FILE-x and so on before the extension.
std::filesystem::path model_path(const DiagnoseOptions& options, const Diagnosis& diagnosis,
                                 std::size_t axes) {
  std::filesystem::path path = options.model_out;
  if (axes == 1) return path;
  return path.parent_path() /
         fmt::format("{}-{}{}", path.stem().string(), diagnosis.axis, path.extension().string());
}

void write_results(const DiagnoseOptions& options, const std::vector<Diagnosis>& diagnoses,
                   const std::optional<OdometerDiagnosis>& odometer,
                   const std::optional<diagnose::DriveDiagnosis>& drives,
                   const std::vector<std::string>& doubts) {
  const std::string recording = file_name(options.recording);
  if (!options.outputs.report.empty()) {
    report::Report report =
        diagnose::make_report(diagnoses,
                              {.title = "Diagnosis of " + recording,
                               .recording = recording,
                               .provenance = fmt::format("zerorate {}, zerorate diagnose {}",
                                                         ZERORATE_VERSION, recording)},
                              drives ? &*drives : nullptr);
    if (odometer) diagnose::add_odometer(report, *odometer);
    report.write(options.outputs.report);
  }
  if (!options.outputs.json.empty()) {
    write_text(options.outputs.json,
               diagnose::to_json(diagnoses, doubts, odometer ? &*odometer : nullptr,
                                 drives ? &*drives : nullptr));
  }
  if (options.model_out.empty()) return;
  for (const Diagnosis& diagnosis : diagnoses) {
    const auto path = model_path(options, diagnosis, diagnoses.size());
    write_text(path, model::format_model(diagnosis.extended_model));
    if (options.outputs.prints_text())
      fmt::print("{}: the model of axis {}\n", path.string(), diagnosis.axis);
  }
}

ExitCode run_diagnose(DiagnoseOptions& options) {
  options.recording = to_input(options.input_flags);
  std::optional<OdometerDiagnosis> odometer = examine_odometer(options);
  std::vector<std::string> doubts;
  std::vector<Diagnosis> diagnoses = run_diagnosis(options, odometer, doubts);
  const auto drives = examine_drives(options, diagnoses);
  if (odometer && odometer->find("motion_in_stops") != nullptr) {
    odometer->gain = measure_gain(options, diagnoses);
  }
  if (options.outputs.prints_text()) {
    if (odometer) print_odometer(*odometer);
    if (diagnoses.size() > 1) print_verdicts(diagnoses, drives ? &*drives : nullptr);
    for (const Diagnosis& diagnosis : diagnoses) print_diagnosis(diagnosis, options.is_verbose);
    if (drives) print_drives(*drives, diagnoses, options.is_verbose);
  }
  write_results(options, diagnoses, odometer, drives, doubts);
  const bool unexplained = std::ranges::find(diagnoses, diagnose::Verdict::unexplained,
                                             &Diagnosis::verdict) != diagnoses.end() ||
                           (drives && drives->verdict == diagnose::Verdict::unexplained);
  return unexplained || !doubts.empty() ? finding : success;
}

}  // namespace

Command add_diagnose(CLI::App& app) {
  auto* command = app.add_subcommand(
      "diagnose",
      "Find what white + 1/f noise does not explain in a recording, and extend the "
      "model");
  const auto options = std::make_shared<DiagnoseOptions>();
  add_input_options(*command, options->input_flags);
  add_rest_options(*command, options->still_from);
  add_axis_option(*command, options->axis);
  command->add_option(
      "--model", options->model,
      "sensor model to be tested as it stands, not fitted: a TOML file or a name from 'zerorate "
      "model list'; misfit, adequacy, gain and verdict are against it. Without it, against the "
      "white + 1/f model that fits the recording best");
  command->add_option("--model-out", options->model_out,
                      "write the extended model, for 'zerorate replay --model'; of several axes "
                      "FILE-x.toml, FILE-y.toml and FILE-z.toml");
  command
      ->add_option("--holdout", options->holdout,
                   "share at the end of the recording on which the gain is measured")
      ->check(CLI::Range(0.1, 0.7))
      ->capture_default_str();
  add_output_options(*command, options->outputs);
  command->add_flag(
      "--verbose", options->is_verbose,
      "print every statistic that lies outside what is simulated, and how strongly the "
      "recording speaks for each cause (in nats: logarithms of likelihood ratios)");
  command->footer(
      "The axes of a recording are diagnosed together: what their flicker noise has in common is "
      "told\n"
      "by all of them.\n"
      "Rows in which the vehicle moves, by an odometer or still column, are left out.\n"
      "With ref_speed_mps and ref_heading_deg the drives between true stops are diagnosed, too: "
      "scale\n"
      "factor, asymmetry, misalignment, bias and acceleration sensitivity in motion. Headings at\n"
      "stops alone do, such as 0 whenever the vehicle stands in its parking place.\n"
      "With odometer_pulses and ref_speed_mps the odometer is examined, too: motion in stops, "
      "dead\n"
      "band, late messages, double counting, a sensor that dies. Where the vehicle moves in its\n"
      "stops, the sensor is diagnosed in their calm, and the gain in heading is measured.\n"
      "Verdicts: consistent (white + 1/f + constant does, or the model given), explained (the "
      "causes named are "
      "needed,\n"
      "and nothing is left), unexplained (something is left; no cause is proven).\n"
      "Exit codes: 0 consistent or explained, 1 unexplained, or the recording may not be one at "
      "rest,\n"
      "2 wrong usage, 3 data that cannot be used.\n"
      "Examples:\n"
      "  zerorate diagnose rest.csv.gz --report why.html\n"
      "  zerorate diagnose rest.csv.gz --axis z --model-out extended.toml\n"
      "  zerorate replay other.csv.gz --model extended.toml --schedule still=60,drive=300,seed=1\n"
      "  zerorate diagnose rest.csv --model lsm6dso.toml --json -\n"
      "The JSON is described in docs/reference/diagnosis-json.md.");
  return {command, [options] { return run_diagnose(*options); }};
}

}  // namespace zerorate::cli

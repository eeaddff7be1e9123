/// @file
/// A diagnosis in words, as charts, as JSON and as a report.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/diagnose/result/diagnosis.hpp"
#include "host_tools/lib/diagnose/result/drive_diagnosis.hpp"
#include "host_tools/lib/odometry/odometer_findings.hpp"
#include "host_tools/lib/report/chart.hpp"
#include "host_tools/lib/report/report.hpp"

namespace zerorate::diagnose {

/// Verdict, and whether what is left matters for the heading: "unexplained, but it does not matter
/// for the heading".
[[nodiscard]] std::string verdict_in_words(const Diagnosis& diagnosis);

/// One paragraph with the error of the simulation, its causes, rejected causes and the gain of the
/// extended model; or that nothing is wrong; or what is left, and that no cause is proven.
[[nodiscard]] std::string in_words(const Diagnosis& diagnosis);

/// Gain in heading of learning from the calm alone.
[[nodiscard]] std::string in_words(const odometry::HeadingGain& gain);

/// Causes in the order of their cost in heading to a node without them. Causes that the node cannot
/// follow come last, the strongest first.
[[nodiscard]] std::vector<const Cause*> causes_by_cost(const Diagnosis& diagnosis);

/// The causes on one line: "rate random walk (99 % sure), quantization (100 % sure)"; "none"
/// without any.
[[nodiscard]] std::string causes_in_words(std::span<const Cause* const> causes);
[[nodiscard]] std::string causes_in_words(const Diagnosis& diagnosis);

/// An error before and after: "1.04 to 0.869 deg"; where both read the same, once.
[[nodiscard]] std::string change_in_words(double before_deg, double after_deg);

/// Heading drift before and after on one line: "1.04 to 0.869 deg in 94 s"; empty without drives.
[[nodiscard]] std::string drift_in_words(const Diagnosis& diagnosis);

/// Drives in words: the error of the heading, the causes, and what is left.
[[nodiscard]] std::string in_words(const DriveDiagnosis& drives);
/// Verdict of the drives; "not examined" where they were not.
[[nodiscard]] std::string verdict_in_words(const DriveDiagnosis& drives);
[[nodiscard]] std::string causes_in_words(const DriveDiagnosis& drives);
/// Heading error of the drives held out: "1.41 to 0.196 deg rms over 10 drives"; empty without any.
[[nodiscard]] std::string drift_in_words(const DriveDiagnosis& drives);

/// A cause of rest or of motion.
struct Cost {
  std::string where;  ///< axis, or "drives"
  const Cause* cause = nullptr;
};
/// All causes in the order of what they cost the heading: the least ratio of the errors with their
/// extension over those without it first.
[[nodiscard]] std::vector<Cost> causes_by_cost(std::span<const Diagnosis> axes,
                                               const DriveDiagnosis& drives);

/// "0.0012", or "below 1e-6".
[[nodiscard]] std::string p_value_in_words(double p);

/// Name of an effect for readers: "rate random walk".
[[nodiscard]] std::string plain_name(std::string_view effect);

/// Name of a statistic for readers: "the Allan deviation".
[[nodiscard]] std::string plain_statistic(std::string_view statistic);

/// Unit at the end of a name in JSON: "deg/s"; empty where it has none.
[[nodiscard]] std::string_view unit_of(std::string_view name);

/// Name of a parameter for readers: "time constant, s" for "time_constant_s".
[[nodiscard]] std::string plain_parameter(std::string_view name);

/// Whether something matters for the heading: "it matters", "no matter", or "not decided".
[[nodiscard]] std::string_view matter_in_words(std::optional<bool> is_material);

[[nodiscard]] report::Chart allan_chart(const Diagnosis& diagnosis);
[[nodiscard]] report::Chart density_chart(const Diagnosis& diagnosis);
/// The recording with an effect drawn over it.
[[nodiscard]] report::Chart effect_chart(const Diagnosis& diagnosis, const Drawing& drawing);
[[nodiscard]] report::BarChart evidence_chart(const Diagnosis& diagnosis);
/// Errors of prediction, extended over base.
[[nodiscard]] report::BarChart error_chart(const Gain& gain);
[[nodiscard]] report::BarChart coverage_chart(const Gain& gain);

/// One axis: the object itself; several: a list of such objects under "axes".
/// @param doubts  possible signs of motion, under "doubts"
/// @param odometer  faults of the odometer, under "odometer"; nullptr: not examined
/// @param drives  under "drives", and with the axes under "causes_by_cost"; nullptr: not examined
[[nodiscard]] std::string to_json(std::span<const Diagnosis> axes,
                                  const std::vector<std::string>& doubts = {},
                                  const odometry::OdometerDiagnosis* odometer = nullptr,
                                  const DriveDiagnosis* drives = nullptr);

struct ReportText {
  std::string title;
  std::string recording;   ///< name of the recording in a command
  std::string provenance;  ///< command that makes the report again
};

/// Report of each axis: the verdict in words, the causes and their parameters, Allan deviation and
/// density over what the models simulate, the effect over the data, the evidence, what the
/// extension buys, and the extended model with the commands that run it.
/// @param drives  a section before those of the axes; nullptr: not examined
[[nodiscard]] report::Report make_report(std::span<const Diagnosis> axes, const ReportText& text,
                                         const DriveDiagnosis* drives = nullptr);

/// Adds a section of the drives: causes of rest and motion by their cost, the errors over the
/// turns, the time and the speed with what the causes predict, and each drive before and after.
void add_drives(report::Report& report, const DriveDiagnosis& drives,
                std::span<const Diagnosis> axes);

/// Adds a section with the faults of the odometer.
void add_odometer(report::Report& report, const odometry::OdometerDiagnosis& odometer);

}  // namespace zerorate::diagnose

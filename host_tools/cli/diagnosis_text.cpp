#include "host_tools/cli/diagnosis_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "host_tools/cli/terminal.hpp"
#include "host_tools/lib/diagnose/presentation/presentation.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::cli {
namespace {

using diagnose::Diagnosis;
using units::in_figures;

std::string rivals_in_words(const diagnose::Cause& cause) {
  std::string rivals;
  for (const diagnose::Alternative& rival : cause.alternatives) {
    rivals += fmt::format("{}{} ({:.1f} nats behind)", rivals.empty() ? "; or " : ", ",
                          diagnose::plain_name(rival.effect), rival.less_likely_by_nats);
  }
  return rivals;
}

void print_cause(const diagnose::Cause& cause, bool is_verbose) {
  fmt::print("\n  {}: {:.0f} % sure{}{}{}\n", diagnose::plain_name(cause.effect),
             100.0 * cause.probability, cause.in_model ? ", in the model" : ", not in the model",
             cause.axes > 1 ? ", of all axes together" : "", rivals_in_words(cause));
  for (const diagnose::Parameter& parameter : cause.parameters) {
    fmt::print("    {:<37} {:>12} [{}, {}]\n", parameter.name, in_figures(parameter.value, 4),
               in_figures(parameter.lo, 4), in_figures(parameter.hi, 4));
  }
  if (!is_verbose) return;
  fmt::print("    {:<37} {:>12.1f} nats, p {}\n", "evidence", cause.gain_nats,
             diagnose::p_value_in_words(cause.p_value));
  if (const auto& drift = cause.heading_drift_ratio) {
    fmt::print("    {:<37} {:>12.3f} [{:.3f}, {:.3f}]\n", "heading drift with over without it",
               drift->value, drift->lo, drift->hi);
  }
}

void print_misfit(const Diagnosis& diagnosis) {
  if (std::ranges::none_of(diagnosis.misfit, &diagnose::Misfit::is_outside)) return;
  fmt::print("\n  {:<27} {:<23} {:>12}  {}\n", "statistic", "where", "recording",
             diagnosis.is_base_given ? "given model, simulated" : "white + 1/f, simulated");
  for (const diagnose::Misfit& row : diagnosis.misfit) {
    if (!row.is_outside()) continue;
    fmt::print("  {:<27} {:<23} {:>12}  {} to {}\n", row.statistic, row.where,
               in_figures(row.measured, 4), in_figures(row.simulated_lo, 4),
               in_figures(row.simulated_hi, 4));
  }
}

void print_estimate(const char* what, const diagnose::BootstrapFigure& estimate) {
  if (!std::isfinite(estimate.value)) return;
  fmt::print("  {:<37} {:>12.4g} [{:.4g}, {:.4g}]\n", what, estimate.value, estimate.lo,
             estimate.hi);
}

void print_gain(const char* over, const diagnose::Gain& gain, bool is_verbose) {
  if (!gain.is_measured()) return;
  fmt::print("\n  on {} samples held out, extended model over {}\n", gain.holdout_samples, over);
  if (is_verbose) {
    print_estimate("RSSE ratio", gain.rsse_ratio);
    print_estimate("integrated error ratio", gain.ie_ratio);
  }
  print_estimate("heading drift ratio", gain.heading_drift_ratio);
  print_estimate("coverage of 95 %, before", gain.coverage95_base);
  print_estimate("coverage of 95 %, extended", gain.coverage95_extended);
  print_estimate("log score gain [nats per sample]", gain.log_score_gain_nats_per_sample);
}

}  // namespace

void print_odometer(const odometry::OdometerDiagnosis& odometer) {
  if (odometer.findings.empty()) {
    fmt::print("odometer: healthy by the reference's speed\n\n");
    return;
  }
  for (const odometry::OdometerFinding& finding : odometer.findings) {
    fmt::print("odometer: {}\n\n{}\n", finding.name, finding.sentence);
    for (const auto& [name, figure] : finding.figures) {
      fmt::print("    {:<37} {:>12.4g}", name, figure.value);
      if (std::isfinite(figure.lo)) fmt::print(" [{:.4g}, {:.4g}]", figure.lo, figure.hi);
      fmt::print("\n");
    }
    fmt::print("\n");
  }
  if (!odometer.configuration.empty()) {
    fmt::print("for the configuration of zerorated:\n\n{}\n", odometer.configuration);
  }
  if (odometer.gain) fmt::print("{}\n\n", diagnose::in_words(*odometer.gain));
}

void print_diagnosis(const Diagnosis& diagnosis, bool is_verbose) {
  fmt::print("\naxis {}: {}\n\n{}\n", diagnosis.axis, diagnose::verdict_in_words(diagnosis),
             wrapped(diagnose::in_words(diagnosis)));
  for (const std::string& remark : diagnosis.remarks)
    fmt::print("{}\n", wrapped("note: " + remark));
  for (const diagnose::Cause* cause : diagnose::causes_by_cost(diagnosis)) {
    print_cause(*cause, is_verbose);
  }
  if (is_verbose) print_misfit(diagnosis);
  if (diagnosis.causes.empty()) return;
  print_gain("the model of characterize", diagnosis.gain, is_verbose);
  if (is_verbose) print_gain("white + 1/f noise", diagnosis.gain_over_data_sheet, is_verbose);
}

void print_verdicts(const std::vector<Diagnosis>& diagnoses,
                    const diagnose::DriveDiagnosis* drives) {
  std::vector<std::vector<std::string>> rows{
      {"axis", "verdict", "for the heading", "heading error, held out", "causes"}};
  for (const Diagnosis& diagnosis : diagnoses) {
    const std::string_view matters = diagnosis.verdict == diagnose::Verdict::unexplained
                                         ? diagnose::matter_in_words(diagnosis.is_material())
                                         : "-";
    rows.push_back({diagnosis.axis, std::string(diagnose::name(diagnosis.verdict)),
                    std::string(matters), diagnose::drift_in_words(diagnosis),
                    diagnose::causes_in_words(diagnosis)});
  }
  if (drives != nullptr) {
    rows.push_back({"drives", diagnose::verdict_in_words(*drives), "-",
                    diagnose::drift_in_words(*drives), diagnose::causes_in_words(*drives)});
  }
  fmt::print("{}", aligned(rows));
}

void print_drives(const diagnose::DriveDiagnosis& drives, const std::vector<Diagnosis>& diagnoses,
                  bool is_verbose) {
  fmt::print("\ndrives: {}\n\n{}\n", diagnose::verdict_in_words(drives),
             wrapped(diagnose::in_words(drives)));
  for (const std::string& remark : drives.remarks) fmt::print("{}\n", wrapped("note: " + remark));
  for (const diagnose::Cause& cause : drives.causes) print_cause(cause, is_verbose);
  if (drives.causes_of_errors() > 0) {
    const diagnose::DriveGain& gain = drives.gain;
    fmt::print("\n  on {} drives that the correction was not fitted to\n", gain.held_out);
    print_estimate("heading error before, deg rms", gain.rms_before_deg);
    print_estimate("heading error after, deg rms", gain.rms_after_deg);
    print_estimate("coverage of 95 %, before", gain.coverage95_before);
    print_estimate("coverage of 95 %, after", gain.coverage95_after);
    print_estimate("log score gain [nats per drive]", gain.log_score_nats_per_drive);
  }
  const auto costs = diagnose::causes_by_cost(diagnoses, drives);
  if (costs.size() < 2) return;
  std::vector<std::vector<std::string>> rows{
      {"cause", "where", "heading error with over without it"}};
  for (const diagnose::Cost& cost : costs) {
    const auto& ratio = cost.cause->heading_drift_ratio;
    rows.push_back({diagnose::plain_name(cost.cause->effect), cost.where,
                    ratio ? in_figures(ratio->value) : "not measured"});
  }
  fmt::print("\n{}", aligned(rows));
}

}  // namespace zerorate::cli

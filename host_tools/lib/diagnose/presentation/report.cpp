#include "host_tools/lib/diagnose/presentation/presentation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <iterator>
#include <vector>

#include "firmware/model/model_file.hpp"

namespace zerorate::diagnose {
namespace {

std::string figure(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "–";
}

std::vector<report::KeyFigure> key_figures(const Diagnosis& diagnosis) {
  std::vector<report::KeyFigure> figures{
      {"Verdict", std::string(name(diagnosis.verdict)),
       fmt::format("{} samples every {:.4g} s", diagnosis.samples, diagnosis.sample_period_s)}};
  for (const Cause* cause : causes_by_cost(diagnosis)) {
    figures.push_back({"Cause", plain_name(cause->effect),
                       fmt::format("{:.0f} % sure; {:.1f} nats{}, p {}", 100.0 * cause->probability,
                                   cause->gain_nats, cause->axes > 1 ? " of all axes" : "",
                                   p_value_in_words(cause->p_value))});
  }
  const Gain& gain = diagnosis.gain;
  if (gain.has_drives()) {
    const std::string base = fmt::format("{:.3g}°", gain.heading_drift_base_deg.value);
    const std::string extended = fmt::format("{:.3g}°", gain.heading_drift_extended_deg.value);
    const bool is_same = base == extended;
    figures.push_back({"Heading drift", is_same ? base : base + " → " + extended,
                       fmt::format("rms over {:.0f} s, held-out data{}", gain.drive_s,
                                   is_same ? "; the same with both models" : "")});
    figures.push_back(
        {"Interval coverage", fmt::format("{:.0f} %", 100.0 * gain.coverage95_extended.value),
         fmt::format("nominal 95 %; {:.0f} % before", 100.0 * gain.coverage95_base.value)});
  }
  return figures;
}

report::Table parameter_table(const Diagnosis& diagnosis) {
  report::Table table{
      .caption = "The causes and their parameters.",
      .columns = {
          {"Cause"}, {"Parameter"}, {"Value"}, {"95 % interval"}, {"Rivals within 3 nats"}}};
  for (const Cause& cause : diagnosis.causes) {
    std::string rivals;
    for (const Alternative& rival : cause.alternatives) {
      rivals += fmt::format("{}{} ({:.1f})", rivals.empty() ? "" : ", ", plain_name(rival.effect),
                            rival.less_likely_by_nats);
    }
    if (rivals.empty()) rivals = "none";
    bool is_first = true;
    for (const Parameter& parameter : cause.parameters) {
      table.rows.push_back({is_first ? plain_name(cause.effect) : "",
                            plain_parameter(parameter.name), figure(parameter.value),
                            fmt::format("{} to {}", figure(parameter.lo), figure(parameter.hi)),
                            is_first ? rivals : ""});
      is_first = false;
    }
    if (cause.parameters.empty()) {
      table.rows.push_back({plain_name(cause.effect), "", "", "", rivals});
    }
  }
  return table;
}

/// "Allan deviation, deg/s"
std::string statistic_with_unit(const std::string& statistic) {
  std::string text = plain_statistic(statistic).substr(4);  // without "the "
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  const std::string_view unit = unit_of(statistic);
  return unit.empty() ? text : fmt::format("{}, {}", text, unit);
}

/// The rows that are furthest out, relative to the width of what is simulated, in their own order.
std::vector<Misfit> worst_misfits(const Diagnosis& diagnosis, std::size_t most) {
  std::vector<Misfit> rows;
  std::ranges::copy_if(diagnosis.misfit, std::back_inserter(rows), &Misfit::is_outside);
  if (rows.size() <= most) return rows;
  const auto widths_outside = [](const Misfit& row) {
    const double beyond =
        std::max(row.measured - row.simulated_hi, row.simulated_lo - row.measured);
    return beyond / (row.simulated_hi - row.simulated_lo);
  };
  std::vector<double> departures;
  std::ranges::transform(rows, std::back_inserter(departures), widths_outside);
  std::ranges::nth_element(departures, departures.begin() + static_cast<std::ptrdiff_t>(most) - 1,
                           std::greater{});
  const double least = departures[most - 1];
  std::erase_if(rows, [&](const Misfit& row) { return widths_outside(row) < least; });
  return rows;
}

report::Table misfit_table(const Diagnosis& diagnosis) {
  constexpr std::size_t kMostRows = 12;
  const auto all = std::ranges::count_if(diagnosis.misfit, &Misfit::is_outside);
  const std::vector<Misfit> rows = worst_misfits(diagnosis, kMostRows);
  report::Table table{
      .caption = fmt::format("Statistics of the recording that lie outside what the base model "
                             "simulates, the worst {} of {}.",
                             rows.size(), all),
      .columns = {{"Statistic"}, {"Where"}, {"Recording"}, {"Simulations"}}};
  for (const Misfit& row : rows) {
    table.rows.push_back(
        {statistic_with_unit(row.statistic), row.where, figure(row.measured),
         fmt::format("{} to {}", figure(row.simulated_lo), figure(row.simulated_hi))});
  }
  return table;
}

report::Table evidence_table(const Diagnosis& diagnosis) {
  report::Table table{.columns = {{"Effect"},
                                  {.heading = "Gain", .unit = "nats", .decimals = 1},
                                  {.heading = "Price", .unit = "nats", .decimals = 1},
                                  {"In the model"}}};
  for (const SelectionEvidence& evidence : diagnosis.evidence) {
    const bool examined = evidence.not_examined.empty();
    table.rows.push_back(
        {plain_name(evidence.effect),
         examined ? report::Cell(evidence.gain_nats) : report::Cell("–"),
         examined ? report::Cell(evidence.price_nats) : report::Cell("–"),
         examined ? (evidence.selected ? "yes" : "") : "not examined: " + evidence.not_examined});
  }
  return table;
}

report::Table gain_table(const Gain& gain) {
  report::Table table{
      .caption =
          "Base and extended model run by the node's filter on data that neither was "
          "fitted to. Ratios are extended over base: below 1 is better.",
      .columns = {{"Figure"}, {"Value"}, {"95 % interval"}}};
  const auto add = [&](const char* what, const BootstrapFigure& estimate) {
    if (!std::isfinite(estimate.value)) return;
    table.rows.push_back({what, figure(estimate.value),
                          fmt::format("{} to {}", figure(estimate.lo), figure(estimate.hi))});
  };
  add("RSSE ratio", gain.rsse_ratio);
  add("Integrated error ratio", gain.ie_ratio);
  add("Heading drift ratio", gain.heading_drift_ratio);
  add("Heading drift before, deg", gain.heading_drift_base_deg);
  add("Heading drift after, deg", gain.heading_drift_extended_deg);
  add("Coverage before", gain.coverage95_base);
  add("Coverage after", gain.coverage95_extended);
  add("Log score gain, nats per sample", gain.log_score_gain_nats_per_sample);
  return table;
}

/// "Evidence" of a recording of one axis, "Axis x: evidence" of several.
std::string heading(const Diagnosis& diagnosis, std::string what) {
  if (diagnosis.axis != "rate") {
    what[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(what[0])));
    what.insert(0, "Axis " + diagnosis.axis + ": ");
  }
  return what;
}

void add_misfit(report::Report& report, const Diagnosis& diagnosis) {
  auto& section = report.section(heading(diagnosis, "Simulation against recording"));
  if (!diagnosis.allan.empty()) section.chart(allan_chart(diagnosis));
  if (!diagnosis.density.empty()) section.chart(density_chart(diagnosis));
  if (std::ranges::any_of(diagnosis.misfit, &Misfit::is_outside)) {
    section.table(misfit_table(diagnosis));
  }
  for (const std::string& failure : diagnosis.extended_adequacy.failures) {
    section.paragraph("Not explained: " + failure + ".");
  }
}

void add_gain(report::Report& report, const Diagnosis& diagnosis) {
  const Gain& gain = diagnosis.gain;
  auto& section = report.section(heading(diagnosis, "What the extension buys"));
  const report::BarChart errors = error_chart(gain);
  if (!errors.categories.empty()) section.chart(errors);
  if (gain.has_drives()) section.chart(coverage_chart(gain));
  section.table(gain_table(gain));
}

void add_model(report::Report& report, const Diagnosis& diagnosis, const std::string& recording) {
  const std::string axis = diagnosis.axis == "rate" ? "" : " --axis " + diagnosis.axis;
  report.section(heading(diagnosis, "Run it on the node"))
      .paragraph(
          "The extended model is the node's own: the same file runs in a replay, in the "
          "node on Linux and in the firmware. Write it, and try it on stops and drives:")
      .listing(fmt::format("zerorate diagnose {0}{1} --model-out extended.toml\n"
                           "zerorate replay {0}{1} --model extended.toml \\\n"
                           "    --schedule still=60,drive=300,seed=1",
                           recording, axis))
      .listing(model::format_model(diagnosis.extended_model));
}

void add_axis(report::Report& report, const Diagnosis& diagnosis, const ReportText& text) {
  const std::string axis = diagnosis.axis == "rate" ? "Verdict" : "Axis " + diagnosis.axis;
  auto& verdict = report.section(fmt::format("{}: {}", axis, verdict_in_words(diagnosis)));
  verdict.key_figures(key_figures(diagnosis)).paragraph(in_words(diagnosis));
  if (!diagnosis.causes.empty()) verdict.table(parameter_table(diagnosis));
  for (const std::string& remark : diagnosis.remarks) verdict.paragraph(remark);
  for (const Drawing& drawing : diagnosis.drawings) verdict.chart(effect_chart(diagnosis, drawing));
  add_misfit(report, diagnosis);
  if (!diagnosis.evidence.empty()) {
    report.section(heading(diagnosis, "Evidence"))
        .chart(evidence_chart(diagnosis))
        .table(evidence_table(diagnosis));
  }
  if (diagnosis.causes.empty()) return;
  if (diagnosis.gain.is_measured()) add_gain(report, diagnosis);
  add_model(report, diagnosis, text.recording);
}

constexpr std::string_view kLead =
    "Does this sensor behave like white noise, 1/f noise and a constant? Where not, why, and what "
    "is "
    "the better model worth?";

report::Table verdict_table(std::span<const Diagnosis> axes, const DriveDiagnosis* drives) {
  report::Table table{
      .caption =
          "Causes in the order of what they cost the heading. Heading error of the node before and "
          "after their correction, on data that the correction was not fitted to.",
      .columns = {{"Where"}, {"Verdict"}, {"Causes"}, {"Heading error"}}};
  if (drives != nullptr) {
    table.rows.push_back({"drives about " + drives->vertical, verdict_in_words(*drives),
                          causes_in_words(*drives), drift_in_words(*drives)});
  }
  for (const Diagnosis& axis : axes) {
    table.rows.push_back({axis.axis + " at rest", verdict_in_words(axis), causes_in_words(axis),
                          drift_in_words(axis)});
  }
  return table;
}

}  // namespace

report::Report make_report(std::span<const Diagnosis> axes, const ReportText& text,
                           const DriveDiagnosis* drives) {
  report::Report report{text.title, std::string(kLead)};
  if (axes.size() > 1 || drives != nullptr) {
    report.section("Verdicts").table(verdict_table(axes, drives));
  }
  if (drives != nullptr) add_drives(report, *drives, axes);
  for (const Diagnosis& axis : axes) add_axis(report, axis, text);
  report.provenance(text.provenance);
  return report;
}

void add_odometer(report::Report& report, const odometry::OdometerDiagnosis& odometer) {
  auto& section = report.section("Odometer");
  if (odometer.findings.empty()) {
    section.paragraph("The odometer is healthy by the reference's speed.");
    return;
  }
  report::Table table{.caption = "Figures with their 95 % intervals",
                      .columns = {{"Finding"}, {"Figure"}, {"Value"}, {"From"}, {"To"}}};
  for (const odometry::OdometerFinding& finding : odometer.findings) {
    section.paragraph(finding.name + ": " + finding.sentence);
    for (const auto& [name, value] : finding.figures) {
      table.rows.push_back(
          {finding.name, name, figure(value.value), figure(value.lo), figure(value.hi)});
    }
  }
  section.table(table);
  if (!odometer.configuration.empty()) {
    section.paragraph("What a node should know of this odometer:");
    section.listing(odometer.configuration);
  }
  if (odometer.gain) section.paragraph(in_words(*odometer.gain));
}

}  // namespace zerorate::diagnose

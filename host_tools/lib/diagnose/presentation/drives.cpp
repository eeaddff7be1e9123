#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "host_tools/lib/diagnose/presentation/presentation.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::in_figures;
using units::kDegPerRad;

std::string rivals_in_words(const Cause& cause) {
  std::vector<std::string> names;
  for (const Explanation& one : cause.set95) {
    names.push_back(fmt::format("{} ({:.0f} %)", plain_name(one.effect), 100.0 * one.probability));
  }
  return cause.stands_alone()
             ? ""
             : fmt::format(" These drives cannot decide: it is one of {}.", fmt::join(names, ", "));
}

/// One dot a drive.
template <class Figure, class Value>
report::Series dots(std::string name, report::Colour colour, const std::vector<DrivePoint>& points,
                    const Figure& figure, const Value& value_rad) {
  report::Series series{
      .name = std::move(name), .style = report::SeriesStyle::points, .colour = colour};
  for (const DrivePoint& point : points) {
    series.x.push_back(figure(point));
    series.y.push_back(value_rad(point) * kDegPerRad);
  }
  return series;
}

double error_of(const DrivePoint& point) {
  return point.error_rad;
}

report::Axis error_axis() {
  return {"Heading error, gyro less reference", "deg"};
}

/// Errors over a figure of the drives, and what the causes explain of them.
template <class Figure>
report::Chart chart_over(const DriveDiagnosis& drives, std::string title, std::string caption,
                         report::Axis x, const Figure& figure) {
  report::Chart chart{.title = std::move(title),
                      .caption = std::move(caption),
                      .x = std::move(x),
                      .y = error_axis()};
  std::vector<DrivePoint> points = drives.points;
  std::ranges::sort(points, {}, figure);
  chart.series.push_back(dots("error", report::Colour::ink, points, figure, error_of));
  if (drives.causes_of_errors() == 0) return chart;
  chart.caption += " Blue is what the causes predict for the same drive.";
  chart.series.push_back(dots("predicted by the causes", report::Colour::blue, points, figure,
                              [](const DrivePoint& point) { return point.share_rad; }));
  return chart;
}

/// Times of departure, counted from the earliest: stamps may count from 1970.
report::Axis departures_from_first(const DriveDiagnosis& drives) {
  const auto first = std::ranges::min_element(drives.points, {}, &DrivePoint::departure_s);
  return {.label = "Departure after the first one",
          .unit = "s",
          .origin = first == drives.points.end() ? 0.0 : first->departure_s};
}

/// Errors of the drives in their order, before and after the causes are taken off, and what noise,
/// bias and reference let expect.
report::Chart before_and_after(const DriveDiagnosis& drives) {
  report::Chart chart{
      .title = "Heading error drive by drive.",
      .caption = "Grey: where noise, bias and reference alone put 95 % of the drives.",
      .x = departures_from_first(drives),
      .y = error_axis()};
  const auto departure = [](const DrivePoint& point) { return point.departure_s; };
  std::vector<DrivePoint> points = drives.points;
  std::ranges::sort(points, {}, departure);
  report::Series expected{.name = "95 % by noise, bias and reference",
                          .colour = report::Colour::grey};
  for (const DrivePoint& point : points) {
    const double reach = statistics::kHalfWidth95 * point.sigma_rad * kDegPerRad;
    expected.x.push_back(departure(point));
    expected.y.push_back(0.0);
    expected.lo.push_back(-reach);
    expected.hi.push_back(reach);
  }
  chart.series.push_back(std::move(expected));
  chart.series.push_back(dots("error", report::Colour::ink, points, departure, error_of));
  if (drives.causes_of_errors() == 0) return chart;
  chart.series.push_back(
      dots("left after correction", report::Colour::blue, points, departure,
           [](const DrivePoint& point) { return point.error_rad - point.share_rad; }));
  return chart;
}

std::string percent_of(const BootstrapFigure& share) {
  return fmt::format("{:.0f} %", 100.0 * share.value);
}

std::vector<report::KeyFigure> key_figures(const DriveDiagnosis& drives) {
  std::vector<report::KeyFigure> figures{
      {"Verdict", verdict_in_words(drives),
       fmt::format("{} drives about axis {}", drives.drives, drives.vertical)}};
  for (const Cause& cause : drives.causes) {
    figures.push_back({"Cause", plain_name(cause.effect),
                       fmt::format("{:.0f} % sure", 100.0 * cause.probability)});
  }
  const DriveGain& gain = drives.gain;
  if (gain.held_out == 0) return figures;
  const std::string before = in_figures(gain.rms_before_deg.value) + "°";
  const std::string after = in_figures(gain.rms_after_deg.value) + "°";
  figures.push_back(
      {"Heading error", before == after ? before : before + " → " + after,
       fmt::format("rms of {} drives that the correction was not fitted to", gain.held_out)});
  figures.push_back(
      {"Coverage of the node's interval", percent_of(gain.coverage95_after),
       fmt::format("of these drives, nominal 95 %; {} before, by an interval that has "
                   "room for the tolerances of the model",
                   percent_of(gain.coverage95_before))});
  return figures;
}

report::Table cost_table(std::span<const Diagnosis> axes, const DriveDiagnosis& drives) {
  report::Table table{
      .caption =
          "Causes at standstill and while driving, the dearest first: heading error after "
          "correction over that before, on data that the correction was not fitted to.",
      .columns = {{"Cause"}, {"Where"}, {"Ratio"}, {"95 % interval"}}};
  for (const Cost& cost : causes_by_cost(axes, drives)) {
    const auto& ratio = cost.cause->heading_drift_ratio;
    table.rows.push_back(
        {plain_name(cost.cause->effect), cost.where,
         ratio ? in_figures(ratio->value) : "not measured",
         ratio ? fmt::format("{} to {}", in_figures(ratio->lo), in_figures(ratio->hi)) : ""});
  }
  return table;
}

report::Table figures_table(const DriveDiagnosis& drives) {
  report::Table table{.caption = "Causes while driving, with their figures.",
                      .columns = {{"Cause"}, {"Parameter"}, {"Value"}, {"95 % interval"}}};
  for (const Cause& cause : drives.causes) {
    for (const Parameter& parameter : cause.parameters) {
      table.rows.push_back(
          {plain_name(cause.effect), plain_parameter(parameter.name), in_figures(parameter.value),
           fmt::format("{} to {}", in_figures(parameter.lo), in_figures(parameter.hi))});
    }
  }
  return table;
}

}  // namespace

std::string verdict_in_words(const DriveDiagnosis& drives) {
  return drives.obstacle.empty() ? std::string(name(drives.verdict)) : "not examined";
}

std::string causes_in_words(const DriveDiagnosis& drives) {
  std::vector<const Cause*> causes;
  for (const Cause& cause : drives.causes) causes.push_back(&cause);
  return causes_in_words(causes);
}

std::string drift_in_words(const DriveDiagnosis& drives) {
  const DriveGain& gain = drives.gain;
  if (gain.held_out == 0) return {};
  return fmt::format("{} rms over {} drives",
                     change_in_words(gain.rms_before_deg.value, gain.rms_after_deg.value),
                     gain.held_out);
}

std::string in_words(const DriveDiagnosis& drives) {
  if (!drives.obstacle.empty()) {
    std::string text = "The drives are not diagnosed: " + drives.obstacle + ".";
    for (const Cause& cause : drives.causes) text += " " + cause.sentence;
    return text;
  }
  std::string text = fmt::format(
      "Over {} drives between true stops the heading errs by {} deg rms about axis {}, after the "
      "bias of the stops before and after each drive was subtracted.",
      drives.drives, in_figures(drives.rms_rad * kDegPerRad), drives.vertical);
  for (const Cause& cause : drives.causes) {
    if (cause.heading_drift_ratio) text += " " + cause.sentence + rivals_in_words(cause);
  }
  const std::size_t of_errors = drives.causes_of_errors();
  if (of_errors > 0) {
    text += fmt::format(" After correction {} deg rms are left.",
                        in_figures(drives.rms_left_rad * kDegPerRad));
  }
  for (const Cause& cause : drives.causes) {
    if (!cause.heading_drift_ratio) text += " " + cause.sentence;
  }
  if (drives.verdict == Verdict::unexplained) {
    text += fmt::format(
        " What is left is {:.2g} times what noise, bias and reference let expect, and no effect of "
        "the catalogue explains it; a reference may err more on the way than at its stops.",
        drives.scatter);
  }
  for (const Cause& cause : drives.causes) {
    if (cause.in_model) continue;
    text += fmt::format(" The model leaves out the {}: {}.", plain_name(cause.effect),
                        cause.left_out_because);
  }
  return text;
}

std::vector<Cost> causes_by_cost(std::span<const Diagnosis> axes, const DriveDiagnosis& drives) {
  std::vector<Cost> costs;
  for (const Cause& cause : drives.causes) costs.push_back({"drives", &cause});
  for (const Diagnosis& axis : axes) {
    for (const Cause& cause : axis.causes) costs.push_back({axis.axis, &cause});
  }
  std::ranges::stable_sort(costs, {}, [](const Cost& cost) {
    const auto& ratio = cost.cause->heading_drift_ratio;
    return ratio ? ratio->value : std::numeric_limits<double>::infinity();
  });
  return costs;
}

void add_drives(report::Report& report, const DriveDiagnosis& drives,
                std::span<const Diagnosis> axes) {
  auto& section = report.section("Drives: " + verdict_in_words(drives));
  if (!drives.points.empty()) section.key_figures(key_figures(drives));
  section.paragraph(in_words(drives));
  for (const std::string& remark : drives.remarks) section.paragraph(remark);
  if (drives.points.empty()) return;
  if (!causes_by_cost(axes, drives).empty()) section.table(cost_table(axes, drives));
  if (!drives.causes.empty()) section.table(figures_table(drives));
  section
      .chart(chart_over(drives, "Heading error over the turn.",
                        "A dot is the error at the end of a drive. An error of the scale factor "
                        "puts the dots on a line through zero.",
                        {"Turn", "deg"},
                        [](const DrivePoint& point) { return point.turn_rad * kDegPerRad; }))
      .chart(chart_over(drives, "Heading error over the time in motion.",
                        "A bias that is there only in motion puts the dots on a line.",
                        {"Time in motion", "s"},
                        [](const DrivePoint& point) { return point.moving_s; }))
      .chart(chart_over(drives, "Heading error over the speed.",
                        "A bias that follows the speed or the vibration makes the dots rise or "
                        "fall.",
                        {"Mean speed", "m/s"},
                        [](const DrivePoint& point) { return point.metres / point.moving_s; }))
      .chart(before_and_after(drives));
}

}  // namespace zerorate::diagnose

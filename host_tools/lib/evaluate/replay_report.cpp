#include "host_tools/lib/evaluate/replay_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "host_tools/lib/evaluate/learnt_model.hpp"
#include "host_tools/lib/evaluate/replay_json.hpp"
#include "host_tools/lib/evaluate/true_drives_report.hpp"
#include "host_tools/lib/identify/allan_deviation.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::evaluate {
namespace {

using report::Chart;
using report::Colour;

using units::kDegPerRad;
constexpr double kDphPerDps = 3600.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Title for readers.
std::string_view title(app::Predictor predictor) {
  switch (predictor) {
    case app::Predictor::kalman:
      return "Kalman";
    case app::Predictor::moving_average:
      return "Moving average";
    case app::Predictor::calibration_mean:
      return "Calibration mean";
  }
  return "Unknown";
}

Colour colour(app::Predictor predictor) {
  switch (predictor) {
    case app::Predictor::kalman:
      return Colour::blue;
    case app::Predictor::moving_average:
      return Colour::green;
    case app::Predictor::calibration_mean:
      return Colour::vermilion;
  }
  return Colour::by_position;
}

void shade_stops(Chart& chart, const ReplayTrace& trace) {
  for (const auto& stop : trace.stops()) chart.shaded.push_back({stop.from_s, stop.to_s});
  chart.shaded_name = "standstill";
}

Chart rate_chart(const ReplayTrace& trace) {
  Chart chart{.title = "Measured and corrected rate",
              .caption = "Output of the gyro, and rate that the node publishes. Drag to zoom.",
              .x = {.label = "Time", .unit = "s", .origin = trace.start_s()},
              .y = {"Rate", "deg/s"}};
  report::Series measured{.name = "measured", .colour = Colour::grey};
  report::Series corrected{.name = "corrected", .colour = Colour::blue};
  for (const TracePoint& point : trace.points()) {
    measured.x.push_back(point.time_s);
    measured.y.push_back(point.measured_dps);
    corrected.x.push_back(point.time_s);
    corrected.y.push_back(point.calibrated ? point.corrected_dps : kNan);
  }
  chart.series = {std::move(measured), std::move(corrected)};
  shade_stops(chart, trace);
  return chart;
}

/// The measured rate less the true one, averaged over about a minute. Empty where the true rate is
/// not known.
report::Series true_bias(const ReplayTrace& trace) {
  constexpr double kAveraging = 60.0;
  report::Series series{.name = "true bias (60 s means)", .colour = Colour::ink, .dashed = true};
  double sum = 0.0;
  double start = kNan;
  double time_sum = 0.0;
  std::size_t count = 0;
  for (const TracePoint& point : trace.points()) {
    if (!std::isfinite(point.error_dps)) continue;
    if (count > 0 && point.time_s - start >= kAveraging) {
      series.x.push_back(time_sum / static_cast<double>(count));
      series.y.push_back(sum / static_cast<double>(count) * kDphPerDps);
      sum = time_sum = 0.0;
      count = 0;
    }
    if (count == 0) start = point.time_s;
    sum += point.error_dps;
    time_sum += point.time_s;
    ++count;
  }
  return series;
}

Chart bias_chart(const ReplayTrace& trace) {
  Chart chart{.title = "Predicted bias with its 95 % interval",
              .caption =
                  "While the vehicle stands still the bias is measured; while it drives it is "
                  "predicted, and the interval grows as the sensor's noise allows. Without a "
                  "prediction the mean of the last stop would stand for it. The true bias, where "
                  "it is known, is the measured less the true rate.",
              .x = {.label = "Time", .unit = "s", .origin = trace.start_s()},
              .y = {"Bias", "deg/h"}};
  report::Series predicted{.name = "predicted bias", .colour = Colour::blue};
  report::Series mean{.name = "mean of the last stop",
                      .style = report::SeriesStyle::steps,
                      .colour = colour(app::Predictor::calibration_mean)};
  for (const TracePoint& point : trace.points()) {
    const double bias = point.calibrated ? point.bias_dps * kDphPerDps : kNan;
    const double half_width = statistics::kHalfWidth95 * point.sigma_dps * kDphPerDps;
    predicted.x.push_back(point.time_s);
    predicted.y.push_back(bias);
    predicted.lo.push_back(bias - half_width);
    predicted.hi.push_back(bias + half_width);
    mean.x.push_back(point.time_s);
    mean.y.push_back(point.calibrated ? point.last_stop_mean_dps * kDphPerDps : kNan);
  }
  chart.series = {std::move(predicted), std::move(mean)};
  if (report::Series truth = true_bias(trace); !truth.x.empty()) {
    chart.series.push_back(std::move(truth));
  }
  shade_stops(chart, trace);
  return chart;
}

Chart drift_chart(const ReplayTrace& trace) {
  Chart chart{.title = "Heading drift of each drive",
              .caption =
                  "The integral of the corrected rate less the true turn, drive by drive. The "
                  "bar at each drive is the Kalman predictor's own 95 % interval.",
              .x = {.label = "Start of the drive", .unit = "s", .origin = trace.start_s()},
              .y = {"Heading drift", "deg"}};
  for (const app::Predictor predictor : kAllPredictors) {
    const auto p = static_cast<std::size_t>(predictor);
    report::Series series{.name = std::string(title(predictor)),
                          .style = report::SeriesStyle::points,
                          .colour = colour(predictor)};
    for (const TracedDrive& drive : trace.drives()) {
      const DriveOutcome& outcome = drive.outcomes[p];
      series.x.push_back(drive.start_s);
      series.y.push_back(outcome.drift_rad * kDegPerRad);
      if (predictor == app::Predictor::kalman) {
        series.lo.push_back(-statistics::kHalfWidth95 * outcome.sigma_rad * kDegPerRad);
        series.hi.push_back(statistics::kHalfWidth95 * outcome.sigma_rad * kDegPerRad);
      }
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

report::BarChart drift_bars(const ReplayResult& result, const std::vector<std::size_t>& axes) {
  report::BarChart chart{.title = "Heading drift per drive",
                         .caption = "Root mean square over all drives; shorter is better.",
                         .y = {"Heading drift", "deg"}};
  for (const std::size_t axis : axes) chart.categories.push_back(axis_name(result, axis));
  for (const app::Predictor predictor : kAllPredictors) {
    report::BarGroup group{.name = std::string(title(predictor)), .colour = colour(predictor)};
    for (const std::size_t axis : axes) {
      const auto& scores = result.scores[axis][static_cast<std::size_t>(predictor)];
      group.values.push_back(scores.heading_drift_rms_rad() * kDegPerRad);
    }
    chart.groups.push_back(std::move(group));
  }
  return chart;
}

report::Table score_table(const ReplayResult& result, const std::vector<std::size_t>& axes) {
  report::Table table{
      .caption =
          "Ratio: drift over that of the calibration mean, with its 95 % interval by a bootstrap "
          "over the drives; below 1 is better. Coverage: share of the drives whose drift lies in "
          "the predicted 95 % interval; 0.95 is nominal. Sigma / "
          "rms: mean of the predicted standard deviations over the rms drift; a right model has 1 "
          "with drives of equal length and about 0.75 with drives of random length. RSSE (root "
          "sum of squared errors): the root of the sum of the squared rate errors over the "
          "samples of a drive. IE (integrated error): the drift with its sign, so that a "
          "systematic one shows. Both are means over the drives.",
      .columns = {{"Axis"},
                  {"Predictor"},
                  {.heading = "Drives"},
                  {"Heading drift", "deg rms", 4},
                  {.heading = "Ratio [95 %]"},
                  {.heading = "Coverage", .decimals = 3},
                  {.heading = "Sigma / rms", .decimals = 2},
                  {"RSSE", "deg/s", 3},
                  {"IE", "deg", 4}}};
  for (const std::size_t axis : axes) {
    const auto& baseline = result.scores[axis].back();
    for (const app::Predictor predictor : kAllPredictors) {
      const auto& scores = result.scores[axis][static_cast<std::size_t>(predictor)];
      table.rows.push_back({axis_name(result, axis), std::string(title(predictor)), scores.drives(),
                            scores.heading_drift_rms_rad() * kDegPerRad,
                            in_words(drift_ratio(scores, baseline)), scores.coverage95(),
                            scores.sigma_over_rms(), scores.mean_rsse_rad_s() * kDegPerRad,
                            scores.mean_integrated_rad() * kDegPerRad});
    }
  }
  return table;
}

Chart allan_chart(const RestRecord& rest, const model::SensorModel& model) {
  Chart chart{.title = "Allan deviation at rest",
              .caption = rest.caption,
              .x = {"Averaging time", "s", report::Scale::logarithmic},
              .y = {"Allan deviation", "deg/h", report::Scale::logarithmic}};
  report::Series measured{.name = "recording, 95 % interval", .colour = Colour::blue};
  report::Series expected{
      .name = "model: white noise and 1/f", .colour = Colour::ink, .dashed = true};
  const double dph = kDegPerRad * kDphPerDps;
  const double arw = model.white.angle_random_walk_rad_per_sqrt_s;
  for (const auto& point : identify::allan_deviation(rest.rate_rad_s, rest.sample_period_s)) {
    measured.x.push_back(point.tau_s);
    measured.y.push_back(point.adev * dph);
    measured.lo.push_back(point.lo * dph);
    measured.hi.push_back(point.hi * dph);
    // IEEE Std 952: N^2 / tau of white noise, (2 ln 2 / pi) B^2 of 1/f noise.
    if (model.flicker && model.flicker->order == 0.5) {
      const double b = model.flicker->bias_instability_rad_s;
      expected.x.push_back(point.tau_s);
      expected.y.push_back(
          std::sqrt(arw * arw / point.tau_s + 2.0 * std::numbers::ln2 / std::numbers::pi * b * b) *
          dph);
    }
  }
  chart.series.push_back(std::move(measured));
  if (!expected.x.empty()) chart.series.push_back(std::move(expected));
  return chart;
}

std::vector<report::KeyFigure> key_figures(const ReplayResult& result, std::size_t axis) {
  const DriveScores& kalman = result.scores[axis].front();
  const DriveScores& mean = result.scores[axis].back();
  return {{"Drives", std::to_string(kalman.drives()), "axis " + axis_name(result, axis)},
          {"Heading drift", fmt::format("{:.3f}°", kalman.heading_drift_rms_rad() * kDegPerRad),
           "Kalman, rms per drive"},
          {"Against the mean of the stop", in_words(drift_ratio(kalman, mean)),
           "ratio of drifts with its 95 % interval; below 1 is better"},
          {"Interval coverage", fmt::format("{:.0f} %", kalman.coverage95() * 100.0),
           "of drives inside the 95 % interval"}};
}

}  // namespace

std::string summary(const ReplayResult& result, std::size_t axis) {
  const DriveScores& kalman = result.scores[axis].front();
  const DriveScores& mean = result.scores[axis].back();
  if (result.true_drives && !result.truth_known) {
    return summary(*result.true_drives, result.axis_count);
  }
  if (!result.truth_known) {
    return "The true rate of this recording is not known, so drift cannot be scored; add "
           "--schedule "
           "if the sensor was at rest all the time.";
  }
  if (kalman.drives() == 0) {
    return "No drive followed a calibration, so there is nothing to score.";
  }
  return fmt::format(
      "Over {} drives the heading of axis {} drifted by {:.3f} deg rms with the Kalman predictor "
      "and "
      "by {:.3f} deg with the mean of the last stop (ratio {}); {:.0f} % of the drives lay "
      "inside the predicted 95 % interval.",
      kalman.drives(), axis_name(result, axis), kalman.heading_drift_rms_rad() * kDegPerRad,
      mean.heading_drift_rms_rad() * kDegPerRad, in_words(drift_ratio(kalman, mean)),
      kalman.coverage95() * 100.0);
}

report::Report make_report(const ReplayResult& result, const std::vector<std::size_t>& axes,
                           const ReplayTrace& trace, const RestRecord& rest,
                           const model::SensorModel& model, const ReplayReportText& text) {
  const bool scored = result.truth_known && result.scores[trace.axis()].front().drives() > 0;
  report::Report report{text.title, text.lead + " " + summary(result, trace.axis()) +
                                        report::origin_in_words(trace.start_s())};
  auto& bias = report.section("Bias of axis " + axis_name(result, trace.axis()));
  if (scored) bias.key_figures(key_figures(result, trace.axis()));
  bias.chart(bias_chart(trace)).chart(rate_chart(trace));
  if (scored) {
    report.section("Heading drift")
        .chart(drift_chart(trace))
        .chart(drift_bars(result, axes))
        .table(score_table(result, axes));
  }
  if (result.true_drives) add_true_drives(report, *result.true_drives, trace, result);
  add_learnt_model(report, result, axes, trace);
  if (!rest.rate_rad_s.empty()) {
    report.section("The sensor's noise").chart(allan_chart(rest, model));
  }
  report.provenance(text.provenance);
  return report;
}

namespace {

report::Chart learnt_chart(const ReplayTrace& trace, std::string title, report::Axis y,
                           LearntInterval LearntModel::*figure) {
  report::Chart chart{.title = std::move(title),
                      .caption = "At the end of each stop; the band is the 95 % interval.",
                      .x = {.label = "Time", .unit = "s", .origin = trace.start_s()},
                      .y = std::move(y)};
  report::Series series{
      .name = "learnt", .style = report::SeriesStyle::steps, .colour = report::Colour::blue};
  for (const TracedModel& traced : trace.models()) {
    const LearntInterval& learnt = traced.model.*figure;
    series.x.push_back(traced.time_s);
    series.y.push_back(learnt.value);
    series.lo.push_back(learnt.lo);
    series.hi.push_back(learnt.hi);
  }
  chart.series.push_back(std::move(series));
  return chart;
}

report::Table learnt_table(const ReplayResult& result, const std::vector<std::size_t>& axes) {
  report::Table table{
      .caption =
          "Noise model by the end, with 95 % intervals. Evidence: the figures rest on as many "
          "stops "
          "of full weight; older stops count in part.",
      .columns = {
          {"Axis"}, {"Evidence", "stops", 1}, {"Order d"}, {"B, deg/h"}, {"N, deg/s/sqrt(Hz)"}}};
  for (const std::size_t axis : axes) {
    const LearntModel learnt = learnt_model((*result.learnt)[axis], result.mesh);
    table.rows.push_back({axis_name(result, axis), learnt.stops, in_words(learnt.order),
                          in_words(learnt.bias_instability_dph),
                          in_words(learnt.angle_random_walk_dps_per_sqrt_hz)});
  }
  return table;
}

}  // namespace

void add_learnt_model(report::Report& report, const ReplayResult& result,
                      const std::vector<std::size_t>& axes, const ReplayTrace& trace) {
  if (!result.learnt) return;
  const std::string axis = " of axis " + axis_name(result, trace.axis());
  constexpr auto kLogarithmic = report::Scale::logarithmic;
  report.section("Noise model learnt from the stops")
      .table(learnt_table(result, axes))
      .chart(learnt_chart(trace, "Order" + axis, {"Order d", ""}, &LearntModel::order))
      .chart(learnt_chart(trace, "Bias instability" + axis, {"B", "deg/h", kLogarithmic},
                          &LearntModel::bias_instability_dph))
      .chart(learnt_chart(trace, "Angle random walk" + axis, {"N", "deg/s/sqrt(Hz)", kLogarithmic},
                          &LearntModel::angle_random_walk_dps_per_sqrt_hz));
}

}  // namespace zerorate::evaluate

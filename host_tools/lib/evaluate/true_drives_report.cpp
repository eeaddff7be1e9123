#include "host_tools/lib/evaluate/true_drives_report.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::evaluate {
namespace {

using report::Chart;
using report::Colour;
using statistics::kHalfWidth95;
using units::kDegPerRad;
using units::seconds;

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();  // breaks a line

/// A row of bars along the time axis: a line at one height that is broken between them.
class BandRow {
 public:
  BandRow(std::string name, double height, Colour colour)
      : height_(height), series_{.name = std::move(name), .colour = colour} {}

  void add(double from_s, double to_s) {
    for (const double x : {from_s, to_s}) {
      series_.x.push_back(x);
      series_.y.push_back(height_);
    }
    series_.x.push_back(to_s);
    series_.y.push_back(kGap);
  }
  [[nodiscard]] report::Series series() && { return std::move(series_); }

 private:
  double height_;
  report::Series series_;
};

/// Parts of the odometer's stops that the node did not learn from.
void add_discarded(BandRow& row, const ReplayTrace& trace, double filter_tick_s) {
  auto learnt = trace.learnt().begin();
  for (const ReplayTrace::Interval& stop : trace.stops()) {
    double from_s = stop.from_s;
    for (; learnt != trace.learnt().end(); ++learnt) {
      const double begin_s = trace.start_s() + filter_tick_s * learnt->from;
      const double end_s = trace.start_s() + filter_tick_s * learnt->to;
      if (begin_s >= stop.to_s) break;
      if (begin_s > from_s) row.add(from_s, begin_s);
      from_s = std::max(from_s, end_s);
      if (end_s > stop.to_s) break;
    }
    if (stop.to_s > from_s) row.add(from_s, stop.to_s);
  }
}

/// The heading's error within each drive; between them the line is broken.
Chart error_chart(const TrueDrives& drives, const ReplayTrace& trace) {
  Chart chart{.title = "Heading error along each drive",
              .caption =
                  "From two seconds before a departure to two seconds after the arrival: the "
                  "integral of the published rate, minus the turn of the reference. The slope "
                  "is the bias error.",
              .x = {.label = "Time", .unit = "s", .origin = trace.start_s()},
              .y = {"Heading error", "deg"}};
  report::Series series{.name = "heading error", .colour = Colour::blue};
  for (const ScoredTrueDrive& scored : drives.drives) {
    if (scored.along.empty()) continue;
    for (const ScoredTrueDrive::Point& point : scored.along) {
      series.x.push_back(point.time_s);
      series.y.push_back(point.error_rad * kDegPerRad);
    }
    series.x.push_back(scored.along.back().time_s);
    series.y.push_back(kGap);
  }
  chart.series.push_back(std::move(series));
  for (const truth::Stop& stop : drives.truth.stops) {
    chart.shaded.push_back({seconds(stop.from_ns), seconds(stop.to_ns)});
  }
  chart.shaded_name = "true stop";
  return chart;
}

/// The error at the end of each drive, with the interval of node and reference.
Chart end_chart(const TrueDrives& drives) {
  Chart chart{.title = "Heading error at the end of each drive",
              .caption =
                  "The bar at each drive is the 95 % interval of the Kalman predictor and the "
                  "reference together.",
              .x = {"Departure", "s"},
              .y = {"Heading error", "deg"}};
  constexpr std::array kColours{Colour::blue, Colour::green, Colour::vermilion};
  for (const app::Predictor predictor : kAllPredictors) {
    const auto p = static_cast<std::size_t>(predictor);
    report::Series series{.name = std::string(name(predictor)),
                          .style = report::SeriesStyle::points,
                          .colour = kColours[p]};
    for (const ScoredTrueDrive& scored : drives.drives) {
      if (scored.flaw != truth::Flaw::none) continue;
      series.x.push_back(seconds(scored.drive.departure_ns));
      series.y.push_back(scored.outcomes[p].drift_rad * kDegPerRad);
      if (predictor != app::Predictor::kalman) continue;
      const double half =
          kHalfWidth95 * kDegPerRad *
          std::hypot(scored.outcomes[p].sigma_rad, drives.truth.reference_error_rad);
      series.lo.push_back(-half);
      series.hi.push_back(half);
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

report::Table score_table(const TrueDrives& drives) {
  report::Table table{
      .caption = fmt::format(
          "Coverage: share of the drives inside the 95 % interval of node and reference, whose own "
          "error is taken as {:.3f} deg; of the node: as if the reference were perfect.",
          drives.truth.reference_error_rad * kDegPerRad),
      .columns = {{"Predictor"},
                  {.heading = "Drives"},
                  {"Rms", "deg", 3},
                  {"Median", "deg", 3},
                  {"Worst", "deg", 3},
                  {"Rms by the bias at departure", "deg", 3},
                  {.heading = "Coverage", .decimals = 3},
                  {.heading = "Coverage of the node", .decimals = 3}}};
  for (const app::Predictor predictor : kAllPredictors) {
    const TrueScore score = drives.score(predictor);
    table.rows.push_back({std::string(name(predictor)), score.drives, score.rms_rad * kDegPerRad,
                          score.median_rad * kDegPerRad, score.worst_rad * kDegPerRad,
                          drives.score(predictor, Scored::bias_at_departure).rms_rad * kDegPerRad,
                          score.coverage95, score.coverage95_of_node});
  }
  return table;
}

report::Table drive_table(const TrueDrives& drives) {
  report::Table table{.caption = "Drives of the " + std::string(name(drives.published)) +
                                 " predictor; those with a remark are not scored.",
                      .columns = {{"Departure", "s", 1},
                                  {"Way", "s", 1},
                                  {"Turn", "deg", 1},
                                  {"Error", "deg", 3},
                                  {"Sigma", "deg", 3},
                                  {"Remark"}}};
  for (const ScoredTrueDrive& scored : drives.drives) {
    const truth::Drive& drive = scored.drive;
    const DriveOutcome& outcome = scored.outcomes[static_cast<std::size_t>(drives.published)];
    const bool is_scored = scored.flaw == truth::Flaw::none;
    table.rows.push_back({seconds(drive.departure_ns),
                          seconds(drive.way_to_ns() - drive.way_from_ns()),
                          is_scored ? drive.way_turn_rad * kDegPerRad : kGap,
                          is_scored ? outcome.drift_rad * kDegPerRad : kGap,
                          is_scored ? outcome.sigma_rad * kDegPerRad : kGap,
                          is_scored ? std::string() : std::string(name(scored.flaw))});
  }
  return table;
}

}  // namespace

std::string doubt_of_coverage(const TrueDrives& drives) {
  constexpr double kPromised = 0.05;
  const double log_unlikely = std::log(1e-3);
  const TrueScore score = drives.score(app::Predictor::kalman);
  if (score.drives == 0) return "";
  const auto count = static_cast<double>(score.drives);
  const double outside = std::round((1.0 - score.coverage95) * count);
  if (statistics::log_poisson_tail(outside, kPromised * count) > log_unlikely) return "";
  return fmt::format(
      "{:.0f} of {} drives lie outside the interval, where one of twenty would by chance: in "
      "motion "
      "the gyro is not what the stops show. 'zerorate diagnose' looks for the cause, such as a "
      "bias "
      "that vibration shifts, or an error of the scale factor.",
      outside, score.drives);
}

std::string summary(const TrueDrives& drives, std::size_t axis_count) {
  const truth::Truth& truth = drives.truth;
  if (!truth.obstacle.empty()) return "Drives are not scored: " + truth.obstacle + ".";
  const TrueScore score = drives.score(app::Predictor::kalman);
  if (score.drives == 0) return "No true drive could be scored.";
  const std::string doubt = doubt_of_coverage(drives);
  return fmt::format(
      "Over {} drives between true stops the published heading erred by {:.3f} deg rms (median "
      "{:.3f}, worst {:.3f}) about axis {}; {:.0f} % of them lay inside the 95 % interval, with "
      "{:.3f} deg for the reference's own error. With the bias at departure alone, from middle to "
      "middle of the stops, {:.3f} deg rms.{}{}",
      score.drives, score.rms_rad * kDegPerRad, score.median_rad * kDegPerRad,
      score.worst_rad * kDegPerRad, name(truth.vertical, axis_count), score.coverage95 * 100.0,
      truth.reference_error_rad * kDegPerRad,
      drives.score(app::Predictor::kalman, Scored::bias_at_departure).rms_rad * kDegPerRad,
      doubt.empty() ? "" : " ", doubt);
}

Chart stop_chart(const ReplayTrace& trace, const TrueDrives& drives, double filter_tick_s) {
  Chart chart{.title = "Stops by truth and by odometer, and what was learnt",
              .caption =
                  "Rows from the top: true stops, stops by the odometer, what of them the "
                  "node learnt from, and what it discarded: settle time, hold-back, and "
                  "what it judged to be motion.",
              .x = {.label = "Time", .unit = "s", .origin = trace.start_s()},
              .y = {"Row", ""}};
  BandRow truth{"true stop", 4.0, Colour::ink};
  for (const truth::Stop& stop : drives.truth.stops) {
    truth.add(seconds(stop.from_ns), seconds(stop.to_ns));
  }
  BandRow odometer{"stop by odometer", 3.0, Colour::grey};
  for (const ReplayTrace::Interval& stop : trace.stops()) odometer.add(stop.from_s, stop.to_s);
  BandRow learnt{"learnt", 2.0, Colour::green};
  for (const ReplayTrace::LearntTicks& ticks : trace.learnt()) {
    learnt.add(trace.start_s() + filter_tick_s * ticks.from,
               trace.start_s() + filter_tick_s * ticks.to);
  }
  BandRow discarded{"discarded", 1.0, Colour::vermilion};
  add_discarded(discarded, trace, filter_tick_s);
  for (BandRow* row : {&truth, &odometer, &learnt, &discarded}) {
    chart.series.push_back(std::move(*row).series());
  }
  return chart;
}

void add_true_drives(report::Report& report, const TrueDrives& drives, const ReplayTrace& trace,
                     const ReplayResult& result) {
  const double filter_tick_s = static_cast<double>(result.filter_tick.ns()) * 1e-9;
  auto& section = report.section("Against the reference");
  section.paragraph(summary(drives, result.axis_count));
  section.chart(stop_chart(trace, drives, filter_tick_s));
  if (drives.scored() == 0) return;
  section.chart(error_chart(drives, trace))
      .chart(end_chart(drives))
      .table(score_table(drives))
      .table(drive_table(drives));
}

namespace {

using Json = nlohmann::ordered_json;
using recording::number;
using units::kDegPerRad;
using units::seconds;

Json score_json(const TrueScore& score) {
  return {{"drives", score.drives},
          {"heading_error_rms_deg", number(score.rms_rad * kDegPerRad)},
          {"heading_error_median_deg", number(score.median_rad * kDegPerRad)},
          {"heading_error_worst_deg", number(score.worst_rad * kDegPerRad)},
          {"coverage95", number(score.coverage95)},
          {"coverage95_of_node", number(score.coverage95_of_node)},
          {"sigma_over_rms", number(score.sigma_over_rms)}};
}

Json outcome_json(const DriveOutcome& outcome) {
  return {{"heading_error_deg", number(outcome.drift_rad * kDegPerRad)},
          {"sigma_deg", number(outcome.sigma_rad * kDegPerRad)}};
}

Json drive_json(const ScoredTrueDrive& scored) {
  Json json{{"from_s", seconds(scored.drive.from_ns)},
            {"departure_s", seconds(scored.drive.departure_ns)},
            {"arrival_s", seconds(scored.drive.arrival_ns)},
            {"to_s", seconds(scored.drive.to_ns)},
            {"flaw", scored.flaw == truth::Flaw::none ? Json(nullptr)
                                                      : Json(std::string(name(scored.flaw)))}};
  if (scored.flaw != truth::Flaw::none) return json;
  json["turn_deg"] = number(scored.drive.turn_rad * kDegPerRad);
  for (const app::Predictor predictor : kAllPredictors) {
    Json& by_predictor = json["predictors"][std::string(name(predictor))];
    by_predictor = outcome_json(scored.outcome(predictor, Scored::published));
    by_predictor["bias_at_departure"] =
        outcome_json(scored.outcome(predictor, Scored::bias_at_departure));
  }
  return json;
}

}  // namespace

Json true_drives_json(const TrueDrives& drives, std::size_t axis_count) {
  const truth::Truth& truth = drives.truth;
  Json stops = Json::array();
  for (const truth::Stop& stop : truth.stops) {
    stops.push_back({{"from_s", seconds(stop.from_ns)}, {"to_s", seconds(stop.to_ns)}});
  }
  Json list = Json::array();
  for (const ScoredTrueDrive& scored : drives.drives) list.push_back(drive_json(scored));
  Json predictors = Json::object();
  for (const app::Predictor predictor : kAllPredictors) {
    Json& by_predictor = predictors[std::string(name(predictor))];
    by_predictor = score_json(drives.score(predictor));
    by_predictor["bias_at_departure"] =
        score_json(drives.score(predictor, Scored::bias_at_departure));
  }
  const bool is_scored = truth.obstacle.empty();
  return {{"obstacle", is_scored ? Json(nullptr) : Json(truth.obstacle)},
          {"vertical_axis", is_scored ? Json(name(truth.vertical, axis_count)) : Json(nullptr)},
          {"turns_ratio", is_scored ? number(truth.vertical.turns_ratio) : Json(nullptr)},
          {"speed_noise_mps", number(truth.speed_noise_m_s)},
          {"speed_limit_mps", number(truth.speed_limit_m_s)},
          {"reference_error_deg", number(truth.reference_error_rad * kDegPerRad)},
          {"reference_error_at_stops_deg", number(truth.error_at_stops_rad * kDegPerRad)},
          {"scored", drives.scored()},
          {"doubt", doubt_of_coverage(drives)},
          {"predictors", std::move(predictors)},
          {"stops", std::move(stops)},
          {"drives", std::move(list)}};
}

}  // namespace zerorate::evaluate

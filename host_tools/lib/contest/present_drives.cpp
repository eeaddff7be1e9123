#include <fmt/format.h>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_tools/lib/contest/presentation.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::contest {

using recording::number;
using units::kDegPerRad;
using units::kDphPerRadS;

std::string label(const evaluate::ScheduleParams& schedule) {
  return fmt::format("{:g}/{:g}", schedule.still_s, schedule.drive_s);
}

std::string axis_label(std::size_t axis) {
  return std::string(1, "xyz"[axis]);
}

void append(std::vector<report::Cell>& row, const BootstrapFigure& figure) {
  for (const double value : {figure.value, figure.lo, figure.hi}) row.emplace_back(value);
}

void append(report::BarGroup& group, const BootstrapFigure& figure) {
  group.values.push_back(figure.value);
  group.lo.push_back(figure.lo);
  group.hi.push_back(figure.hi);
}

void add(nlohmann::ordered_json& into, const std::string& key, const BootstrapFigure& figure) {
  into[key] = number(figure.value);
  into[key + "_ci95"] = {number(figure.lo), number(figure.hi)};
}

nlohmann::ordered_json to_json(const DriveStanding& standing) {
  nlohmann::ordered_json json{{"heading_drift_rms_deg", number(standing.drift_rms_deg)}};
  add(json, "ratio_to_calibration_mean", standing.ratio);
  add(json, "coverage95", standing.coverage);
  json["sigma_over_rms"] = number(standing.sigma_over_rms);
  return json;
}

report::Table fits_table(const std::vector<DriveContest::AxisModels>& fits) {
  report::Table table{.caption = "Noise fitted to each recording, for use as the options say",
                      .columns = {{"recording"},
                                  {"axis"},
                                  {"N", "deg/s/sqrt(Hz)", 4},
                                  {"B", "deg/h", 1},
                                  {"d", "", 3},
                                  {"B at d = 1/2", "deg/h", 1}}};
  for (const auto& fit : fits) {
    const auto& free = fit.extended;
    const double b = free.flicker ? free.flicker->bias_instability_rad_s * kDphPerRadS : 0.0;
    const auto& half = fit.base.flicker;
    table.rows.push_back({fit.recording, axis_label(fit.axis),
                          free.white.angle_random_walk_rad_per_sqrt_s * kDegPerRad, b,
                          free.flicker ? free.flicker->order : std::nan(""),
                          half ? half->bias_instability_rad_s * kDphPerRadS : 0.0});
  }
  return table;
}

namespace {

using Json = nlohmann::ordered_json;
using Row = std::vector<report::Cell>;

/// A row a contestant, a column a schedule, and all of them together with its interval.
report::Table table(const DriveContest& contest, std::string caption,
                    BootstrapFigure DriveStanding::*figure) {
  report::Table table{.caption = std::move(caption), .columns = {{"predictor"}}};
  for (const auto& schedule : contest.options.schedules) {
    table.columns.push_back({label(schedule), "", 3});
  }
  for (const char* heading : {"all", "from", "to"}) table.columns.push_back({heading, "", 3});
  for (std::size_t who = 0; who < kContestants; ++who) {
    const BootstrapFigure overall = contest.overall[who].*figure;
    if (std::isnan(overall.value)) continue;
    Row row{std::string(name(static_cast<Contestant>(who), contest.options.fit_by))};
    for (const auto& standings : contest.by_schedule)
      row.emplace_back((standings[who].*figure).value);
    append(row, overall);
    table.rows.push_back(std::move(row));
  }
  return table;
}

report::BarChart chart(const DriveContest& contest) {
  report::BarChart chart{
      .title = "Heading drift against the mean of the last stop",
      .caption =
          "Root mean square per drive; geometric mean over recording-axes. The bars are 95 % "
          "intervals by the bootstrap over recording-axes.",
      .y = {"Ratio to calibration mean", ""},
      .reference = report::Reference{"calibration mean", 1.0}};
  for (const auto& schedule : contest.options.schedules)
    chart.categories.push_back(label(schedule));
  for (std::size_t who = 0; who + 1 < kContestants; ++who) {
    report::BarGroup group{
        .name = std::string(name(static_cast<Contestant>(who), contest.options.fit_by))};
    for (const auto& standings : contest.by_schedule) append(group, standings[who].ratio);
    chart.groups.push_back(std::move(group));
  }
  return chart;
}

Json json(const std::array<DriveStanding, kContestants>& standings, FitBy fit_by) {
  Json json = Json::object();
  for (std::size_t who = 0; who < kContestants; ++who) {
    json[std::string(name(static_cast<Contestant>(who), fit_by))] =
        contest::to_json(standings[who]);
  }
  return json;
}

std::string to_json(const DriveContest& contest) {
  Json schedules = Json::array();
  for (std::size_t s = 0; s < contest.by_schedule.size(); ++s) {
    schedules.push_back({{"still_s", contest.options.schedules[s].still_s},
                         {"drive_s", contest.options.schedules[s].drive_s},
                         {"predictors", json(contest.by_schedule[s], contest.options.fit_by)}});
  }
  const DriveContestOptions& options = contest.options;
  Json document{{"schema", "zerorate.drives/1"},
                {"recordings", contest.recordings},
                {"fit_on", options.fit_on == FitOn::other ? "other" : "itself"},
                {"fit_by", options.fit_by == FitBy::diagnosis ? "diagnosis" : "characterization"},
                {"seeds", options.seeds},
                {"drives", contest.drives}};
  add(document, "extended_over_base", contest.extended_over_base);
  document["overall"] = json(contest.overall, options.fit_by);
  document["schedules"] = schedules;
  return document.dump(2) + "\n";
}

}  // namespace

Presentation present(const DriveContest& contest) {
  const bool hindsight = contest.options.fit_on == FitOn::itself;
  Presentation presentation{
      .title = "Drives cut out of recordings at rest",
      .lead = fmt::format(
          "{} drives of {} recordings; parameters {}.", contest.drives, contest.recordings.size(),
          hindsight ? "of each recording itself, in hindsight" : "fitted to the other recordings"),
      .json = to_json(contest)};
  presentation.parts = {
      {.heading = "Heading drift",
       .paragraphs =
           {"The true rate is zero, so the integral of the corrected rate over a drive is "
            "its heading drift. Mean lengths of stop/drive in seconds, exponentially "
            "distributed.",
            fmt::format("Over that of the {}, the drift of the {} is {:.3f} ({:.3f} to {:.3f}).",
                        name(Contestant::kalman_base, contest.options.fit_by),
                        name(Contestant::kalman_extended, contest.options.fit_by),
                        contest.extended_over_base.value, contest.extended_over_base.lo,
                        contest.extended_over_base.hi)},
       .tables = {table(contest,
                        "Heading drift rms over that of the calibration mean (stop/drive s)",
                        &DriveStanding::ratio)},
       .bars = {chart(contest)}},
      {.heading = "Interval",
       .paragraphs = {"Share of the drives inside the stated 95 % interval of their heading drift. "
                      "Competitors without an interval are left out."},
       .tables = {table(contest, "Coverage of the 95 % interval", &DriveStanding::coverage)}},
      {.heading = "Noise", .tables = {fits_table(contest.fits)}}};
  return presentation;
}

}  // namespace zerorate::contest

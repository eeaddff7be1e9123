#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_tools/lib/contest/presentation.hpp"
#include "host_tools/lib/evaluate/learnt_model.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::contest {
namespace {

using Json = nlohmann::ordered_json;
using Row = std::vector<report::Cell>;
using evaluate::LearntInterval;
using evaluate::LearntModel;

/// A row a contestant, with the factors of its data sheet and what `add_figures(row, standings)`
/// adds. Factors of a tuned one are NaN: no data sheet has a say in it.
template <class AddFigures>
report::Table table_of(const LearningContest& contest, std::string caption,
                       const std::vector<report::Column>& figures, AddFigures add_figures) {
  report::Table table{.caption = std::move(caption),
                      .columns = {{"filter"}, {"N", "times", 2}, {"B", "times", 2}}};
  table.columns.insert(table.columns.end(), figures.begin(), figures.end());
  const auto add_row = [&](std::string_view who, double white, double flicker,
                           const LearningStandings& standings) {
    Row row{std::string(who), white, flicker};
    add_figures(row, standings);
    table.rows.push_back(std::move(row));
  };
  for (std::size_t i = 0; i < kTuned; ++i) {
    add_row(name(static_cast<Tuned>(i)), std::nan(""), std::nan(""), contest.tuned[i]);
  }
  for (const LearningContest::Case& one : contest.cases) {
    add_row("learning", one.error.white, one.error.flicker, one.learning);
    add_row("fixed", one.error.white, one.error.flicker, one.fixed);
  }
  return table;
}

/// A column a schedule, and all of them together with its interval.
report::Table by_schedule(const LearningContest& contest, std::string caption,
                          BootstrapFigure DriveStanding::*figure) {
  std::vector<report::Column> columns;
  for (const auto& schedule : contest.options.drives.schedules) {
    columns.push_back({label(schedule), "", 3});
  }
  for (const char* heading : {"all", "from", "to"}) columns.push_back({heading, "", 3});
  return table_of(contest, std::move(caption), columns,
                  [&](Row& row, const LearningStandings& standings) {
                    for (const DriveStanding& one : standings.by_schedule) {
                      row.emplace_back((one.*figure).value);
                    }
                    append(row, standings.overall.*figure);
                  });
}

report::Table against_others(const LearningContest& contest) {
  return table_of(
      contest, fmt::format("Heading drift rms over that of the filter {}", name(Tuned::on_others)),
      {{"ratio", "", 3}, {"from", "", 3}, {"to", "", 3}},
      [](Row& row, const LearningStandings& standings) { append(row, standings.over_on_others); });
}

report::Table first_drives(const LearningContest& contest) {
  return table_of(contest,
                  fmt::format("First {} drives of each run", LearningContest::kFirstDrives),
                  {{"ratio", "", 3},
                   {"from", "", 3},
                   {"to", "", 3},
                   {"coverage", "", 3},
                   {"from", "", 3},
                   {"to", "", 3}},
                  [](Row& row, const LearningStandings& standings) {
                    append(row, standings.first_drives.ratio);
                    append(row, standings.first_drives.coverage);
                  });
}

report::BarChart chart(const LearningContest& contest) {
  report::BarChart chart{
      .title = "Heading drift of a node that learns, and of one that does not",
      .caption =
          "Root mean square per drive over that of the filter fitted on the other "
          "recordings; geometric mean over recording-axes. The bars are 95 % intervals by "
          "the bootstrap over recording-axes.",
      .y = {"Ratio to the filter fitted on the others", ""},
      .reference = report::Reference{"fitted on the others", 1.0}};
  report::BarGroup learning{.name = "learning"};
  report::BarGroup fixed{.name = "fixed"};
  for (const LearningContest::Case& one : contest.cases) {
    chart.categories.push_back(
        fmt::format("N x {:.3g}, B x {:.3g}", one.error.white, one.error.flicker));
    append(learning, one.learning.over_on_others);
    append(fixed, one.fixed.over_on_others);
  }
  chart.groups = {std::move(learning), std::move(fixed)};
  return chart;
}

/// Noise fitted to an axis, in the units of LearntModel.
struct Fitted {
  double order;
  double bias_instability_dph;
  double angle_random_walk_dps_per_sqrt_hz;
};

Fitted fitted(const model::SensorModel& model) {
  return {.order = model.flicker ? model.flicker->order : std::nan(""),
          .bias_instability_dph =
              model.flicker ? model.flicker->bias_instability_rad_s * units::kDphPerRadS : 0.0,
          .angle_random_walk_dps_per_sqrt_hz =
              model.white.angle_random_walk_rad_per_sqrt_s * units::kDegPerRad};
}

/// Means of a figure over runs.
struct Means {
  double value = 0.0;
  double lo = 0.0;
  double hi = 0.0;
  double holds_fit = 0.0;  ///< share of the runs whose interval contains the fit
};

Means means_of(const std::vector<const LearntModel*>& runs, LearntInterval LearntModel::*figure,
               double fit) {
  Means means;
  const double share = 1.0 / static_cast<double>(runs.size());
  for (const LearntModel* run : runs) {
    const LearntInterval& learnt = run->*figure;
    means.value += share * learnt.value;
    means.lo += share * learnt.lo;
    means.hi += share * learnt.hi;
    means.holds_fit += learnt.contains(fit) ? share : 0.0;
  }
  return means;
}

/// Figure that a node learns, and its fit.
struct Figure {
  const char* name;
  const char* unit;
  int decimals;
  LearntInterval LearntModel::*learnt;
  double Fitted::*fit;
};
constexpr std::array kFigures{
    Figure{"d", "", 2, &LearntModel::order, &Fitted::order},
    Figure{"B", "deg/h", 1, &LearntModel::bias_instability_dph, &Fitted::bias_instability_dph},
    Figure{"N", "deg/s/sqrt(Hz)", 4, &LearntModel::angle_random_walk_dps_per_sqrt_hz,
           &Fitted::angle_random_walk_dps_per_sqrt_hz}};

report::Table learnt_table(const LearningContest& contest) {
  report::Table table{
      .caption =
          "Noise learnt by the end of a run, with its 95 % interval: means over schedules "
          "and seeds. Inside: share of the runs whose interval contains the fit to the "
          "recording",
      .columns = {{"recording"}, {"axis"}, {"N", "times", 2}, {"B", "times", 2}, {"stops", "", 1}}};
  for (const Figure& figure : kFigures) {
    table.columns.push_back({figure.name, figure.unit, figure.decimals});
    table.columns.push_back({"from", "", figure.decimals});
    table.columns.push_back({"to", "", figure.decimals});
    table.columns.push_back({"fit", "", figure.decimals});
    table.columns.push_back({"inside", "", 2});
  }
  for (const LearningContest::Case& one : contest.cases) {
    for (const auto& fit : contest.fits) {
      std::vector<const LearntModel*> runs;
      double stops = 0.0;
      for (const LearntRun& run : one.runs) {
        if (contest.recordings[run.recording] != fit.recording || run.axis != fit.axis) continue;
        runs.push_back(&run.model);
        stops += run.model.stops;
      }
      if (runs.empty()) continue;
      Row row{fit.recording, axis_label(fit.axis), one.error.white, one.error.flicker,
              stops / static_cast<double>(runs.size())};
      for (const Figure& figure : kFigures) {
        const double fit_value = fitted(fit.extended).*figure.fit;
        const Means means = means_of(runs, figure.learnt, fit_value);
        for (const double value : {means.value, means.lo, means.hi, fit_value, means.holds_fit}) {
          row.emplace_back(value);
        }
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

Json to_json(const LearningContest& contest, const LearningStandings& standings) {
  Json json = to_json(standings.overall);
  add(json, "ratio_to_fitted_on_others", standings.over_on_others);
  json["first_drives"] = to_json(standings.first_drives);
  Json schedules = Json::array();
  for (std::size_t s = 0; s < standings.by_schedule.size(); ++s) {
    const auto& schedule = contest.options.drives.schedules[s];
    Json one{{"still_s", schedule.still_s}, {"drive_s", schedule.drive_s}};
    one.update(contest::to_json(standings.by_schedule[s]));
    schedules.push_back(std::move(one));
  }
  json["schedules"] = std::move(schedules);
  return json;
}

Json runs_json(const LearningContest& contest, const std::vector<LearntRun>& runs) {
  Json json = Json::array();
  for (const LearntRun& run : runs) {
    const auto& schedule = contest.options.drives.schedules[run.schedule];
    Json one{{"recording", contest.recordings[run.recording]},
             {"axis", axis_label(run.axis)},
             {"still_s", schedule.still_s},
             {"drive_s", schedule.drive_s},
             {"seed", run.seed}};
    one.update(evaluate::learnt_json(run.model));
    json.push_back(std::move(one));
  }
  return json;
}

Json fits_json(const LearningContest& contest) {
  Json json = Json::array();
  for (const auto& fit : contest.fits) {
    const Fitted figures = fitted(fit.extended);
    json.push_back(
        {{"recording", fit.recording},
         {"axis", axis_label(fit.axis)},
         {"order", recording::number(figures.order)},
         {"bias_instability_dph", figures.bias_instability_dph},
         {"angle_random_walk_dps_per_sqrt_hz", figures.angle_random_walk_dps_per_sqrt_hz}});
  }
  return json;
}

std::string document(const LearningContest& contest) {
  Json cases = Json::array();
  for (const LearningContest::Case& one : contest.cases) {
    cases.push_back({{"white_factor", one.error.white},
                     {"flicker_factor", one.error.flicker},
                     {"learning", to_json(contest, one.learning)},
                     {"fixed", to_json(contest, one.fixed)},
                     {"learnt", runs_json(contest, one.runs)}});
  }
  return Json{{"schema", "zerorate.learning/1"},
              {"recordings", contest.recordings},
              {"model", contest.options.model.name},
              {"seeds", contest.options.drives.seeds},
              {"drives", contest.drives},
              {"first_drives", LearningContest::kFirstDrives},
              {"fitted_on_others", to_json(contest, contest.tuned[0])},
              {"hindsight", to_json(contest, contest.tuned[1])},
              {"fits", fits_json(contest)},
              {"cases", std::move(cases)}}
             .dump(2) +
         "\n";
}

}  // namespace

Presentation present(const LearningContest& contest) {
  Presentation presentation{
      .title = "A node that learns, on drives cut out of recordings at rest",
      .lead = fmt::format("{} drives of {} recordings; every run starts from nothing with the "
                          "figures of {}, right or wrong.",
                          contest.drives, contest.recordings.size(), contest.options.model.name),
      .json = document(contest)};
  presentation.parts = {
      {.heading = "Heading drift",
       .paragraphs = {"N and B: the data sheet's figures over those of the model. Fixed: the "
                      "filter that takes them at their word. Mean lengths of stop/drive in "
                      "seconds, exponentially distributed."},
       .tables = {by_schedule(contest,
                              "Heading drift rms over that of the calibration mean (stop/drive s)",
                              &DriveStanding::ratio),
                  against_others(contest)},
       .bars = {chart(contest)}},
      {.heading = "Interval",
       .paragraphs = {"Share of the drives inside the stated 95 % interval of their heading "
                      "drift."},
       .tables = {by_schedule(contest, "Coverage of the 95 % interval", &DriveStanding::coverage),
                  first_drives(contest)}},
      {.heading = "Learnt noise", .tables = {learnt_table(contest), fits_table(contest.fits)}}};
  return presentation;
}

}  // namespace zerorate::contest

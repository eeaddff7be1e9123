#include "host_tools/lib/evaluate/learnt_model_report.hpp"

#include <string>
#include <utility>

#include "host_tools/lib/evaluate/learnt_model.hpp"
#include "host_tools/lib/evaluate/replay_json.hpp"

namespace zerorate::evaluate {
namespace {

report::Chart learnt_chart(const ReplayTrace& trace, std::string title, report::Axis y,
                           LearntInterval LearntModel::*figure) {
  report::Chart chart{.title = std::move(title),
                      .caption = "At the end of each stop; the band is the 95 % interval.",
                      .x = {"Time", "s"},
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
          "Noise model by the end, with 95 % intervals. Stops: how many the figures rest on, older "
          "ones counted in part.",
      .columns = {{"Axis"}, {"Stops", "", 1}, {"Order d"}, {"B, deg/h"}, {"N, deg/s/sqrt(Hz)"}}};
  for (const std::size_t axis : axes) {
    const LearntModel learnt = learnt_model((*result.learnt)[axis]);
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

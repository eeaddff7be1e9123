#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "host_tools/lab/paper/presentation.hpp"

namespace zerorate::paper {
namespace {

using Json = nlohmann::ordered_json;
using report::Colour;

report::Chart allan_chart(const std::vector<AllanCurve>& curves) {
  report::Chart chart{.title = "Allan deviation",
                      .caption =
                          "With 95 % intervals. The paper's figure 1 (b): 1/f noise is flat, "
                          "what drifts rises.",
                      .x = {"Averaging time", "s", report::Scale::logarithmic},
                      .y = {"Allan deviation", "deg/h", report::Scale::logarithmic}};
  for (const AllanCurve& curve : curves) {
    report::Series series{.name = curve.name};
    for (const auto& point : curve.points) {
      series.x.push_back(point.tau_s);
      series.y.push_back(point.adev);
      series.lo.push_back(point.lo);
      series.hi.push_back(point.hi);
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

/// The lowest point of each curve, and the curve's last.
report::Table allan_table(const std::vector<AllanCurve>& curves) {
  report::Table table{.caption = "Allan deviations: where they are lowest, and at the longest time",
                      .columns = {{"sensor"},
                                  {"lowest", "deg/h", 2},
                                  {"at", "s", 0},
                                  {"last", "deg/h", 2},
                                  {"from", "deg/h", 2},
                                  {"to", "deg/h", 2},
                                  {"at", "s", 0}}};
  for (const AllanCurve& curve : curves) {
    const auto& lowest = *std::ranges::min_element(curve.points, {}, &identify::AllanPoint::adev);
    const auto& last = curve.points.back();
    table.rows.push_back(
        {curve.name, lowest.adev, lowest.tau_s, last.adev, last.lo, last.hi, last.tau_s});
  }
  return table;
}

/// Where sample `first`, first + 1, ... stand in time.
std::vector<double> times(const ExampleRun& run, std::size_t first, std::size_t count) {
  std::vector<double> result(count);
  for (std::size_t k = 0; k < count; ++k) {
    result[k] = static_cast<double>(first + k) * run.sample_period_s;
  }
  return result;
}

report::Chart run_chart(const ExampleRun& run, const ExampleRun::Prediction& prediction) {
  report::Chart chart{.title = prediction.name,
                      .caption = fmt::format(
                          "IE {:.4g}, RSSE {:.4g}. The band is two sigma of a raw sample, as the "
                          "predictor states it.",
                          prediction.integrated_error, prediction.rsse),
                      .x = {"Time", run.unit.empty() ? "samples" : "s"},
                      .y = {"Rate", run.unit}};
  chart.series.push_back({.name = "data",
                          .x = times(run, 0, run.samples.size()),
                          .y = run.samples,
                          .colour = Colour::grey});
  report::Series band{.name = "predicted",
                      .x = times(run, run.lengths.calibration, run.lengths.prediction),
                      .y = prediction.bias,
                      .colour = Colour::blue};
  for (std::size_t k = 0; k < prediction.bias.size(); ++k) {
    band.lo.push_back(prediction.bias[k] - 2.0 * prediction.sigma[k]);
    band.hi.push_back(prediction.bias[k] + 2.0 * prediction.sigma[k]);
  }
  chart.series.push_back(std::move(band));
  return chart;
}

}  // namespace

Presentation present(const std::vector<AllanCurve>& curves) {
  Json json = Json::array();
  for (const AllanCurve& curve : curves) {
    Json points = Json::array();
    for (const auto& p : curve.points) {
      points.push_back({{"tau_s", p.tau_s}, {"adev_dph", p.adev}, {"lo", p.lo}, {"hi", p.hi}});
    }
    json.push_back({{"name", curve.name}, {"points", points}});
  }
  return {
      .title = "Figure 1 of Kirkko-Jaakkola, Collin and Takala (2012), reproduced",
      .lead =
          "Temperature control keeps the Allan deviation flat; without it the curve rises at "
          "long averaging times.",
      .parts = {{.heading = "Allan deviations",
                 .tables = {allan_table(curves)},
                 .charts = {allan_chart(curves)}}},
      .json = Json{{"schema", "zerorate.reproduce/1"}, {"experiment", "figure1"}, {"curves", json}}
                  .dump(2) +
              "\n"};
}

Presentation present(const ExampleRun& run, int number) {
  report::Table table{
      .caption = "Of this one run: " + run.source,
      .columns = {{"predictor"}, {"IE", run.unit.empty() ? "" : "deg", 3}, {"RSSE", run.unit, 4}}};
  Presentation::Part part{.heading = "Example run"};
  Json json = Json::object();
  for (const auto& prediction : run.predictions) {
    table.rows.push_back({prediction.name, prediction.integrated_error, prediction.rsse});
    part.charts.push_back(run_chart(run, prediction));
    json[prediction.name] = {{"ie", prediction.integrated_error},
                             {"rsse", prediction.rsse},
                             {"bias", prediction.bias},
                             {"sigma", prediction.sigma}};
  }
  part.tables = {table};
  return {.title = fmt::format("Figure {} of Kirkko-Jaakkola, Collin and Takala (2012), reproduced",
                               number),
          .lead =
              "One run, shown sample by sample. Which predictor is best on a single run is "
              "chance; table1 averages over many.",
          .parts = {std::move(part)},
          .json = Json{{"schema", "zerorate.reproduce/1"},
                       {"experiment", fmt::format("figure{}", number)},
                       {"source", run.source},
                       {"unit", run.unit},
                       {"sample_period_s", run.sample_period_s},
                       {"samples", run.samples},
                       {"predictions", json}}
                      .dump(2) +
                  "\n"};
}

}  // namespace zerorate::paper

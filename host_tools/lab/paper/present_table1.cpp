#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "host_tools/lab/paper/presentation.hpp"
#include "host_tools/lib/recording/json.hpp"

namespace zerorate::paper {
namespace {

using Json = nlohmann::ordered_json;
using recording::number;
using Row = std::vector<report::Cell>;

/// A column of the paper's Table I.
struct Printed {
  std::string_view name;
  double mean_ie;
  double std_ie;
  double mean_rsse;
  double std_rsse;
  double ie_ratio;    ///< ratio to its CM
  double rsse_ratio;  ///< ratio to its CM
};

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr Printed kNotPrinted{"", kNan, kNan, kNan, kNan, kNan, kNan};

constexpr std::array kPrintedSimulated = {
    Printed{"full-state Kalman (paper)", -119, 2120, 136, 23.3, 2120.0 / 2280, 136.0 / 138},
    Printed{"moving average", -142, 2210, 139, 25.4, 2210.0 / 2280, 139.0 / 138},
    Printed{"calibration mean", -115, 2280, 138, 24.9, 1.0, 1.0}};
constexpr std::array kPrintedMeasured = {
    Printed{"full-state Kalman (paper)", -.0214, 3.86, .390, .0326, 3.86 / 4.22, .390 / .394},
    Printed{"moving average", -.0258, 3.92, .393, .0339, 3.92 / 4.22, .393 / .394},
    Printed{"calibration mean", -.0728, 4.22, .394, .0350, 1.0, 1.0}};

const Printed& printed(const std::array<Printed, 3>& columns, std::string_view name) {
  for (const Printed& column : columns) {
    if (column.name == name) return column;
  }
  return kNotPrinted;
}

std::vector<report::Column> scale_columns(int decimals, std::string ie_unit,
                                          std::string rsse_unit) {
  return {{"predictor"},
          {"mean IE", ie_unit, decimals},
          {"+-", "", decimals},
          {"paper", "", decimals},
          {"IE std", ie_unit, decimals},
          {"+-", "", decimals},
          {"paper", "", decimals},
          {"mean RSSE", rsse_unit, decimals + 1},
          {"+-", "", decimals + 1},
          {"paper", "", decimals + 1},
          {"RSSE std", rsse_unit, decimals + 1},
          {"paper", "", decimals + 1}};
}

Row scale_row(const Standing& s, const Printed& paper) {
  return {s.name,           s.mean_ie.value, s.mean_ie.error,   paper.mean_ie,     s.std_ie.value,
          s.std_ie.error,   paper.std_ie,    s.mean_rsse.value, s.mean_rsse.error, paper.mean_rsse,
          s.std_rsse.value, paper.std_rsse};
}

/// The expectations of a predictor and of the yardstick; nothing for measured sets, whose noise is
/// not known, and for predictors that are not linear.
struct Expected {
  std::optional<Expectation> own;
  std::optional<Expectation> yardstick;

  [[nodiscard]] double ratio(double Expectation::*member) const {
    return own && yardstick ? *own.*member / *yardstick.*member : kNan;
  }
};

/// Columns without a single number are left out.
report::Table without_empty_columns(report::Table table) {
  for (std::size_t i = table.columns.size(); i-- > 0;) {
    const auto is_empty = [i](const Row& row) {
      const auto* number = std::get_if<double>(&row[i].content());
      return number != nullptr && !std::isfinite(*number);
    };
    if (!std::ranges::all_of(table.rows, is_empty)) continue;
    const auto at = static_cast<std::ptrdiff_t>(i);
    table.columns.erase(table.columns.begin() + at);
    for (Row& row : table.rows) row.erase(row.begin() + at);
  }
  return table;
}

report::Table ie_ratio_table() {
  return {.caption = "Standard deviation of IE over that of the calibration mean, on the same sets",
          .columns = {{"predictor"},
                      {"IE std/CM", "", 4},
                      {"+-", "", 4},
                      {"expected", "", 4},
                      {"paper", "", 4}}};
}

Row ie_ratio_row(const Standing& s, const Expected& expected, const Printed& paper) {
  return {s.name, s.ie_ratio.value, s.ie_ratio.error, expected.ratio(&Expectation::std_ie),
          paper.ie_ratio};
}

report::Table rsse_ratio_table() {
  return {.caption = "Mean RSSE over that of the calibration mean, on the same sets",
          .columns = {{"predictor"},
                      {"RSSE/CM", "", 4},
                      {"+-", "", 4},
                      {"controlled", "", 4},
                      {"+-", "", 4},
                      {"expected", "", 4},
                      {"paper", "", 4}}};
}

Row rsse_ratio_row(const Standing& s, const Figure& controlled, const Expected& expected,
                   const Printed& paper) {
  return {s.name,           s.rsse_ratio.value, s.rsse_ratio.error,
          controlled.value, controlled.error,   expected.ratio(&Expectation::mean_rsse),
          paper.rsse_ratio};
}

/// Whether the predictors know how good they are.
report::Table consistency_table() {
  return {.caption =
              "Share of raw samples within two sigma (95.45 % if sigma is right), and mean "
              "normalised innovation squared (NIS, 1)",
          .columns = {{"predictor"},
                      {"in 2 sigma", "%", 2},
                      {"+-", "", 2},
                      {"expected", "%", 2},
                      {"in 2 own sigma", "%", 2},
                      {"+-", "", 2},
                      {"NIS", "", 4},
                      {"+-", "", 4}}};
}

Row consistency_row(const Standing& s, const Expected& expected) {
  return {s.name,
          100.0 * s.coverage.value,
          100.0 * s.coverage.error,
          expected.own ? 100.0 * expected.own->coverage : kNan,
          100.0 * s.own_coverage.value,
          100.0 * s.own_coverage.error,
          s.nis.value,
          s.nis.error};
}

/// Whether the paper simulated the same.
bool is_of_the_paper(const SimulationOptions& options) {
  return options.lengths.calibration == 1000 && options.lengths.prediction == 1000 &&
         options.noise.order == 0.5 && options.noise.white_variance == 0.0;
}

Presentation::Part simulated_part(const Table1& table) {
  const auto& options = table.options;
  report::Table scale{.caption = fmt::format("Simulated: {} runs of {} + {} samples, d = {:g}",
                                             options.runs, options.lengths.calibration,
                                             options.lengths.prediction, options.noise.order),
                      .columns = scale_columns(0, "", "")};
  report::Table ie = ie_ratio_table();
  report::Table rsse = rsse_ratio_table();
  report::Table consistency = consistency_table();
  for (const SimulatedStanding& s : table.simulated) {
    const Printed& paper =
        is_of_the_paper(options) ? printed(kPrintedSimulated, s.measured.name) : kNotPrinted;
    const Expected expected{s.expected, table.simulated.back().expected};
    scale.rows.push_back(scale_row(s.measured, paper));
    ie.rows.push_back(ie_ratio_row(s.measured, expected, paper));
    rsse.rows.push_back(rsse_ratio_row(s.measured, s.controlled_rsse_ratio, expected, paper));
    consistency.rows.push_back(consistency_row(s.measured, expected));
  }
  return {
      .heading = "Simulated sets",
      .paragraphs =
          {"IE is the sum of the prediction errors, RSSE the root of the sum of their "
           "squares; +- is a standard error. \"Expected\" is what the figure tends to with ever "
           "more runs, from the predictor's weights and the exact covariance of the noise. "
           "\"Controlled\" is the ratio of these runs without most of their luck, which the known "
           "means of the squares reveal (control variates).",
           "Sigma is that of the predictor's error under the noise model. The paper's filter takes "
           "its mean as certain, autoregressive models their mean and coefficients: their "
           "own sigma is smaller."},
      .tables = {scale, ie, rsse, consistency}};
}

Presentation::Part orders_part(const Table1& table) {
  report::Table orders{
      .caption = "Other orders: the decade filter over the optimum of the same order",
      .columns = {{"d", "", 1},
                  {"RSSE/optimum", "", 4},
                  {"+-", "", 4},
                  {"expected", "", 4},
                  {"IE std/optimum", "", 4},
                  {"+-", "", 4},
                  {"expected", "", 4},
                  {"in 2 sigma", "%", 2},
                  {"NIS", "", 4}}};
  for (const auto& s : table.orders) {
    const Expected expected{s.expected_decade_kalman, s.expected_optimum};
    orders.rows.push_back({s.order, s.decade_kalman.rsse_ratio.value,
                           s.decade_kalman.rsse_ratio.error,
                           expected.ratio(&Expectation::mean_rsse), s.decade_kalman.ie_ratio.value,
                           s.decade_kalman.ie_ratio.error, expected.ratio(&Expectation::std_ie),
                           100.0 * s.decade_kalman.coverage.value, s.decade_kalman.nis.value});
  }
  return {.heading = "Other orders d", .tables = {orders}};
}

Presentation::Part cost_part(const Table1& table) {
  report::Table costs{
      .caption = "Time for one more sample after n samples",
      .columns = {
          {"n"}, {"full-state filter", "us", 1}, {"decade filter", "us", 3}, {"ratio", "", 0}}};
  for (const auto& cost : table.costs) {
    costs.rows.push_back({cost.samples, 1e6 * cost.full_state_sample_s, 1e6 * cost.decade_sample_s,
                          cost.full_state_sample_s / cost.decade_sample_s});
  }
  return {
      .heading = "Cost",
      .paragraphs = {"The full-state filter has a state for each sample: with twice the samples, "
                     "a sample costs four times as much, and a calibration eight times. A "
                     "sample costs the decade filter the same at any time."},
      .tables = {costs}};
}

Presentation::Part measured_part(const MeasuredTable& measured) {
  const std::string rate = fmt::format("{:.4g} Hz", 1.0 / measured.sample_period_s);
  report::Table scale{
      .caption = fmt::format("Measured: {} disjoint sets at {}, beside the paper's real data "
                             "(another sensor)",
                             measured.sets, rate),
      .columns = scale_columns(3, "deg", "deg/s")};
  report::Table ie = ie_ratio_table();
  report::Table rsse = rsse_ratio_table();
  report::Table consistency = consistency_table();
  for (const Standing& standing : measured.standings) {
    const Printed& paper = printed(kPrintedMeasured, standing.name);
    scale.rows.push_back(scale_row(standing, paper));
    ie.rows.push_back(ie_ratio_row(standing, {}, paper));
    rsse.rows.push_back(rsse_ratio_row(standing, {kNan, kNan}, {}, paper));
    consistency.rows.push_back(consistency_row(standing, {}));
  }
  report::Table fits{.caption = "Noise used, each fitted on another recording than it is used on",
                     .columns = {{"fitted on"},
                                 {"axis"},
                                 {"white", "deg/h", 1},
                                 {"+-", "", 1},
                                 {"flicker s_f", "deg/h", 2},
                                 {"+-", "", 2},
                                 {"d if free", "", 3},
                                 {"+-", "", 3}}};
  for (const FittedNoise& fit : measured.fits) {
    fits.rows.push_back({fit.recording, std::string(1, "xyz"[fit.axis]), 3600.0 * fit.white.value,
                         3600.0 * fit.white.error, 3600.0 * fit.flicker.value,
                         3600.0 * fit.flicker.error, fit.order.value, fit.order.error});
  }
  return {.heading = "Measured sets at " + rate,
          .tables = {scale, without_empty_columns(ie), without_empty_columns(rsse),
                     without_empty_columns(consistency), fits}};
}

Json json(const Figure& figure) {
  return {{"value", number(figure.value)}, {"standard_error", number(figure.error)}};
}
Json json(const Standing& s) {
  return {{"mean_ie", json(s.mean_ie)},
          {"std_ie", json(s.std_ie)},
          {"mean_rsse", json(s.mean_rsse)},
          {"std_rsse", json(s.std_rsse)},
          {"ie_ratio", json(s.ie_ratio)},
          {"rsse_ratio", json(s.rsse_ratio)},
          {"coverage_2sigma", json(s.coverage)},
          {"own_coverage_2sigma", json(s.own_coverage)},
          {"nis", json(s.nis)}};
}
Json json(const Expectation& e) {
  return {{"std_ie", number(e.std_ie)},
          {"mean_rsse", number(e.mean_rsse)},
          {"std_rsse", number(e.std_rsse)},
          {"coverage_2sigma", number(e.coverage)}};
}

Json json(const MeasuredTable& table) {
  Json predictors = Json::object();
  for (const Standing& s : table.standings) predictors[s.name] = json(s);
  Json fits = Json::array();
  for (const FittedNoise& fit : table.fits) {
    fits.push_back({{"recording", fit.recording},
                    {"axis", std::string(1, "xyz"[fit.axis])},
                    {"white_dps", json(fit.white)},
                    {"flicker_dps", json(fit.flicker)},
                    {"order", json(fit.order)}});
  }
  return {{"sample_period_s", table.sample_period_s},
          {"sets", table.sets},
          {"predictors", predictors},
          {"noise", fits}};
}

std::string to_json(const Table1& table) {
  Json simulated = Json::object();
  for (const SimulatedStanding& s : table.simulated) {
    Json& predictor = simulated[s.measured.name] = json(s.measured);
    predictor["controlled_rsse_ratio"] = json(s.controlled_rsse_ratio);
    if (s.expected) predictor["expected"] = json(*s.expected);
  }
  Json orders = Json::array();
  for (const auto& s : table.orders) {
    orders.push_back({{"d", s.order},
                      {"decade_kalman", json(s.decade_kalman)},
                      {"optimum", json(s.optimum)},
                      {"expected_decade_kalman", json(s.expected_decade_kalman)},
                      {"expected_optimum", json(s.expected_optimum)}});
  }
  Json costs = Json::array();
  for (const auto& cost : table.costs) {
    costs.push_back({{"samples", cost.samples},
                     {"full_state_sample_s", cost.full_state_sample_s},
                     {"decade_sample_s", cost.decade_sample_s}});
  }
  Json measured = Json::array();
  for (const auto& part : table.measured) measured.push_back(json(part));
  return Json{{"schema", "zerorate.reproduce/1"},
              {"experiment", "table1"},
              {"runs", table.options.runs},
              {"seed", table.options.seed},
              {"order", table.options.noise.order},
              {"calibration", table.options.lengths.calibration},
              {"prediction", table.options.lengths.prediction},
              {"simulated", simulated},
              {"orders", orders},
              {"cost", costs},
              {"measured", measured}}
             .dump(2) +
         "\n";
}

}  // namespace

Presentation present(const Table1& table) {
  Presentation presentation{
      .title = "Table I of Kirkko-Jaakkola, Collin and Takala (2012), reproduced",
      .lead =
          "The paper's predictors, the node's own filter with one state a decade, the optimum, "
          "and autoregressive models, on the same simulated and measured sets.",
      .json = to_json(table)};
  presentation.parts = {simulated_part(table), orders_part(table), cost_part(table)};
  for (const MeasuredTable& measured : table.measured) {
    presentation.parts.push_back(measured_part(measured));
  }
  return presentation;
}

}  // namespace zerorate::paper

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_tools/lib/contest/comparison.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::contest {
namespace {

using Json = nlohmann::ordered_json;
using recording::number;
using units::kDegPerRad;
using units::kDphPerRadS;

std::string verdict_on(const Comparison& comparison) {
  const statistics::BootstrapFigure& ratio = comparison.contestants.front().stop_ratio;
  const std::string rival = "the " + comparison.rival.name();
  if (!std::isfinite(ratio.value)) {
    return fmt::format("Too few stops to compare kalman with {}: {} next stops in {} logs.", rival,
                       comparison.stops, comparison.logs.size());
  }
  const char* const word = ratio.hi < 1.0   ? "is better than"
                           : ratio.lo > 1.0 ? "is worse than"
                                            : "cannot be told from";
  return fmt::format(
      "kalman {} {}: its error of the next stop's bias is {:.3g} times as large "
      "(95 %: {:.3g} to {:.3g}).",
      word, rival, ratio.value, ratio.lo, ratio.hi);
}

/// An error of the scale factor with its 95 % interval [%].
std::array<double, 3> percent_of(const ScaleInTurns& scale) {
  constexpr double kPercent = 100.0;
  const double half = statistics::kHalfWidth95 * scale.sigma;
  return {kPercent * scale.error, kPercent * (scale.error - half), kPercent * (scale.error + half)};
}

std::string advice_on_scale(const Comparison& comparison) {
  const ScaleInTurns& scale = *comparison.scale;
  const auto [error, lo, hi] = percent_of(scale);
  const std::string figure = fmt::format("{:.2g} % [{:.2g}, {:.2g}]", error, lo, hi);
  if (!(scale.ratio.hi < 1.0)) {
    return fmt::format(
        "The turns of the reference show no error of the scale factor that matters: {}.", figure);
  }
  return fmt::format(
      "The turns of the reference show an error of the scale factor of {}; with it taken off, the "
      "heading error of kalman is {} times as large.{}",
      figure, evaluate::in_words(scale.ratio),
      comparison.scale_table.empty() ? "" : " In the model:\n" + comparison.scale_table);
}

/// Sentences on what would help, and on what cannot be seen.
std::vector<std::string> advice_on(const Comparison& comparison) {
  std::vector<std::string> advice;
  for (const UnusedInput& input : comparison.unused_inputs) {
    if (!std::isfinite(input.ratio.value)) continue;
    const bool helps = input.ratio.hi < 1.0;
    advice.push_back(fmt::format(
        "The model does not use the {} in these logs; with it the error of kalman is {} times as "
        "large{}",
        input.quantity, evaluate::in_words(input.ratio),
        helps ? ". Add to the model:\n" + input.table : ": that does not help."));
  }
  if (comparison.scale) advice.push_back(advice_on_scale(comparison));
  if (comparison.drives == 0) {
    advice.emplace_back(
        "Without a reference of the heading an error of the scale factor cannot be seen: no bias "
        "shows it. 'zerorate calibrate turns' measures it.");
  }
  return advice;
}

report::Table table_of(const Comparison& comparison) {
  const bool has_drives = comparison.drives > 0;
  report::Table table{
      .caption = fmt::format("{} next stops{} of {} logs", comparison.stops,
                             has_drives ? fmt::format(" and {} drives", comparison.drives) : "",
                             comparison.logs.size()),
      .columns = {{"predictor"}, {"error of the next stop", "deg/h", 2}, {"ratio [95 %]"}}};
  if (has_drives) {
    table.columns.push_back({"heading error", "deg", 3});
    table.columns.push_back({"ratio [95 %]"});
  }
  for (const ContestantScore& one : comparison.contestants) {
    std::vector<report::Cell> row{one.name, one.stop_error_rad_s * kDphPerRadS,
                                  evaluate::in_words(one.stop_ratio)};
    if (has_drives) {
      row.emplace_back(one.heading_error_rad * kDegPerRad);
      row.emplace_back(evaluate::in_words(one.heading_ratio));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string json_of(const Comparison& comparison, const std::string& verdict,
                    const std::vector<std::string>& advice) {
  Json json{{"schema", "zerorate.comparison/1"},
            {"model", comparison.model},
            {"against", comparison.rival.name()},
            {"logs", comparison.logs},
            {"stops", comparison.stops},
            {"drives", comparison.drives},
            {"coverage95", number(comparison.coverage95)},
            {"verdict", verdict},
            {"advice", advice},
            {"contestants", Json::array()},
            {"unused_inputs", Json::array()},
            {"scale_factor", nullptr}};
  if (comparison.scale) {
    const auto [error, lo, hi] = percent_of(*comparison.scale);
    json["scale_factor"] = {{"error_percent", number(error)},
                            {"error_percent_ci95", {number(lo), number(hi)}},
                            {"table", comparison.scale_table}};
    add(json["scale_factor"], "heading_ratio", comparison.scale->ratio);
  }
  for (const ContestantScore& one : comparison.contestants) {
    Json entry{{"name", one.name},
               {"stop_error_dph", number(one.stop_error_rad_s * kDphPerRadS)},
               {"heading_error_deg", number(one.heading_error_rad * kDegPerRad)}};
    add(entry, "stop_ratio", one.stop_ratio);
    add(entry, "heading_ratio", one.heading_ratio);
    json["contestants"].push_back(std::move(entry));
  }
  for (const UnusedInput& input : comparison.unused_inputs) {
    Json entry{{"quantity", input.quantity}, {"table", input.table}};
    add(entry, "stop_ratio", input.ratio);
    json["unused_inputs"].push_back(std::move(entry));
  }
  return json.dump(2) + "\n";
}

}  // namespace

Presentation present(const Comparison& comparison) {
  const std::string verdict = verdict_on(comparison);
  std::vector<std::string> advice = advice_on(comparison);
  advice.push_back(fmt::format(
      "{:.3g} % of the next stops' biases lie in the 95 % interval of kalman. Each is measured in "
      "the first seconds of its stop.",
      100.0 * comparison.coverage95));
  std::string lead = verdict;
  for (const std::string& sentence : advice) lead += "\n" + sentence;
  return {.title = fmt::format("kalman with the model {} against the {}", comparison.model,
                               comparison.rival.name()),
          .lead = std::move(lead),
          .parts = {{.heading = "Errors", .tables = {table_of(comparison)}}},
          .json = json_of(comparison, verdict, advice)};
}

}  // namespace zerorate::contest

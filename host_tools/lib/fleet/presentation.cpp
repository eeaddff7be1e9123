// A population to read, to look at, and for other programs.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "host_tools/lib/fleet/population.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::fleet {
namespace {

using Json = nlohmann::ordered_json;

/// Presentation of a coordinate.
struct Shown {
  const char* name;
  const char* key;
  const char* unit;
  double per_si;
  bool is_log;
};
const std::array<Shown, kCoordinates>& shown() {
  static const std::array<Shown, kCoordinates> all = {
      Shown{"Angle random walk N", "angle_random_walk_dps_per_sqrt_hz", "deg/s/sqrt(Hz)",
            units::kDegPerRad, true},
      Shown{"Bias instability B", "bias_instability_dph", "deg/h", units::kDphPerRadS, true},
      Shown{"Order d", "order", "", 1.0, false}};
  return all;
}

/// A place of the coordinate, so many spreads from the mean, in its unit.
double at(const Population& population, int coordinate, double sigmas) {
  const Shown& one = shown()[static_cast<std::size_t>(coordinate)];
  const double x =
      population.distribution.mean[coordinate] + sigmas * population.spread(coordinate);
  return one.is_log ? one.per_si * std::exp(x) : x;
}

double in_unit(const LotFigure& figure, double value) {
  const auto* const found = std::ranges::find(kCoordinateNames, figure.what);
  if (found == kCoordinateNames.end()) return value;
  return value * shown()[static_cast<std::size_t>(found - kCoordinateNames.begin())].per_si;
}

std::vector<const Sensor*> sensors_where(const Population& population, bool Sensor::*flag,
                                         double Sensor::*order) {
  std::vector<const Sensor*> sensors;
  for (const Sensor& sensor : population.sensors) {
    if (sensor.*flag) sensors.push_back(&sensor);
  }
  std::ranges::stable_sort(sensors, {}, [&](const Sensor* sensor) { return sensor->*order; });
  return sensors;
}
std::vector<const Sensor*> outliers(const Population& population) {
  return sensors_where(population, &Sensor::is_outlier, &Sensor::q_value);
}
std::vector<const Sensor*> changed(const Population& population) {
  return sensors_where(population, &Sensor::has_changed, &Sensor::change_q_value);
}

std::vector<double> temperature_slopes(const Population& population) {
  std::vector<double> slopes;
  for (const StoredRecording& recording : population.recordings) {
    for (const AxisResult& axis : recording.result.axes) {
      if (axis.temperature_slope_rad_s_per_k) {
        slopes.push_back(*axis.temperature_slope_rad_s_per_k * units::kDphPerRadS);
      }
    }
  }
  std::ranges::sort(slopes);
  return slopes;
}

std::string words(const Reason& reason) {
  const char* const place = "{} on axis {} of {}";
  if (reason.name == "distance") {
    return fmt::format("noise far from the rest on axis {} of {}", reason.axis, reason.recording);
  }
  return fmt::format(fmt::runtime(place), reason.name, reason.axis, reason.recording);
}

std::string lead_of(const Population& population) {
  const auto bad_lots = std::ranges::count(population.lots, true, &Lot::differs);
  return fmt::format(
      "{} recordings of {} sensors; {} of {} axes make the population. {} sensors leave it at a "
      "false discovery rate of {:g}, {} lots differ from the others, {} sensors changed between "
      "recordings, and {} recordings could not be used.",
      population.recordings.size(), population.sensors.size(), population.core,
      population.members.size(), outliers(population).size(),
      population.options.false_discovery_rate, bad_lots, changed(population).size(),
      population.bad.size());
}

/// Text as a cell of CSV (RFC 4180).
std::string cell_of(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string{"\"\""} : std::string{c};
  return cell + '"';
}

report::Table distribution_table(const Population& population) {
  report::Table table{.caption =
                          "The spread is that of the sensors: errors of the recordings are "
                          "not in it.",
                      .columns = {{"Figure"},
                                  {"Unit"},
                                  {"Median", "", 5},
                                  {"1 of 40 below", "", 5},
                                  {"1 of 40 above", "", 5},
                                  {"Spread", "of ln N, ln B, d", 3},
                                  {"Error of the mean", "of ln N, ln B, d", 4}}};
  for (int i = 0; i < kCoordinates; ++i) {
    const Shown& one = shown()[static_cast<std::size_t>(i)];
    table.rows.push_back({one.name, one.unit, at(population, i, 0.0),
                          at(population, i, -statistics::kHalfWidth95),
                          at(population, i, statistics::kHalfWidth95), population.spread(i),
                          population.mean_error[i]});
  }
  return table;
}

/// Shares of the sensors' estimates in bins beside what the fitted distribution expects.
report::Chart histogram(const Population& population, int coordinate) {
  constexpr int kBins = 24;
  constexpr double kReach = 4.0;  // spreads
  const Shown& one = shown()[static_cast<std::size_t>(coordinate)];
  std::vector<double> counts(kBins);
  for (const Member& member : population.members) {
    const double sigmas =
        (member.evidence.posterior.mean[coordinate] - population.distribution.mean[coordinate]) /
        population.spread(coordinate);
    const auto bin = static_cast<int>(std::floor((sigmas / kReach + 1.0) * 0.5 * kBins));
    counts[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))] += 1.0;
  }
  report::Series axes{.name = "Axes", .style = report::SeriesStyle::steps};
  report::Series fitted{.name = "Fitted distribution", .dashed = true};
  for (int bin = 0; bin < kBins; ++bin) {
    const double left = (2.0 * bin / kBins - 1.0) * kReach;
    const double middle = left + kReach / kBins;
    axes.x.push_back(at(population, coordinate, left));
    axes.y.push_back(counts[static_cast<std::size_t>(bin)]);
    fitted.x.push_back(at(population, coordinate, middle));
    fitted.y.push_back(static_cast<double>(population.members.size()) * 2.0 * kReach / kBins *
                       std::exp(-0.5 * middle * middle) / std::sqrt(2.0 * std::numbers::pi));
  }
  return {
      .title = one.name,
      .caption =
          "Most probable figure of each axis, the population being known; the last bins "
          "hold all that is farther away.",
      .x = {one.name, one.unit, one.is_log ? report::Scale::logarithmic : report::Scale::linear},
      .y = {"Axes"},
      .series = {std::move(axes), std::move(fitted)}};
}

report::Table effect_table(const Population& population) {
  report::Table table{.columns = {{"Effect"}, {"Axes"}, {"Sensors"}, {"Taken for"}}};
  for (const EffectCount& effect : population.effects) {
    table.rows.push_back({effect.effect, effect.axes, effect.sensors,
                          effect.is_common ? "a property of the type" : "a reason to leave"});
  }
  return table;
}

report::Table lot_table(const Population& population) {
  report::Table table{
      .caption = "p is that of the figure, q the false discovery rate at which the lot is named.",
      .columns = {{"Lot"},
                  {"Figure"},
                  {"Lot", "", 5},
                  {"Others", "", 5},
                  {"p", "", 6},
                  {"q", "", 4},
                  {"Differs"}}};
  constexpr std::size_t kMostRows = 40;
  for (const LotFigure& figure : population.lot_figures) {
    if (table.rows.size() == kMostRows) break;
    table.rows.push_back({population.lots[figure.lot].name, figure.what,
                          in_unit(figure, figure.lot_value), in_unit(figure, figure.other_value),
                          figure.p_value, population.lots[figure.lot].q_value,
                          figure.differs ? "yes" : ""});
  }
  return table;
}

report::Table outlier_table(const Population& population) {
  report::Table table{.columns = {{"Sensor"}, {"Lot"}, {"Reason"}, {"q", "", 6}}};
  for (const Sensor* sensor : outliers(population)) {
    table.rows.push_back({sensor->name, population.lots[sensor->lot].name,
                          words(sensor->reasons.front()), sensor->q_value});
  }
  return table;
}

}  // namespace

std::string to_text(const Population& population) {
  std::string text = lead_of(population) + "\n\n";
  for (int i = 0; i < kCoordinates; ++i) {
    const Shown& one = shown()[static_cast<std::size_t>(i)];
    text += fmt::format("  {:<21} {:>10.4g}  [{:.4g}, {:.4g}] {}\n", one.name,
                        at(population, i, 0.0), at(population, i, -statistics::kHalfWidth95),
                        at(population, i, statistics::kHalfWidth95), one.unit);
  }
  text += "  Medians; 95 % of the axes lie in the brackets.\n";
  for (const EffectCount& effect : population.effects) {
    text += fmt::format("  {:<23} {} axes of {} sensors{}\n", effect.effect, effect.axes,
                        effect.sensors, effect.is_common ? ", a property of the type" : "");
  }
  for (const Sensor* sensor : outliers(population)) {
    text += fmt::format("sensor {}: {} (q = {:.2g})\n", sensor->name,
                        words(sensor->reasons.front()), sensor->q_value);
  }
  for (const LotFigure& figure : population.lot_figures) {
    if (!figure.differs) continue;
    text += fmt::format("lot {}: {} is {:.4g}, of the others {:.4g} (q = {:.2g})\n",
                        population.lots[figure.lot].name, figure.what,
                        in_unit(figure, figure.lot_value), in_unit(figure, figure.other_value),
                        population.lots[figure.lot].q_value);
  }
  for (const Sensor* sensor : changed(population)) {
    text += fmt::format("sensor {}: changed between its recordings (q = {:.2g})\n", sensor->name,
                        sensor->change_q_value);
  }
  for (const StoredRecording& one : population.bad) {
    text += fmt::format("not used: {}: {}\n", one.entry.name, one.problem);
  }
  return text;
}

std::string to_json(const Population& population) {
  Json json = {{"schema", "zerorate.fleet-report/1"},
               {"engine", Database::engine()},
               {"recordings", population.recordings.size()},
               {"sensors", population.sensors.size()},
               {"axes", population.members.size()},
               {"core_axes", population.core},
               {"false_discovery_rate", population.options.false_discovery_rate}};
  for (int i = 0; i < kCoordinates; ++i) {
    const Shown& one = shown()[static_cast<std::size_t>(i)];
    Json& figure = json["distributions"][one.key];
    figure = {{"median", at(population, i, 0.0)},
              {"quantile_025", at(population, i, -statistics::kHalfWidth95)},
              {"quantile_975", at(population, i, statistics::kHalfWidth95)}};
    figure[one.is_log ? "log_mean" : "mean"] =
        population.distribution.mean[i] + (one.is_log ? std::log(one.per_si) : 0.0);
    figure[one.is_log ? "log_spread" : "spread"] = population.spread(i);
    figure["mean_standard_error"] = population.mean_error[i];
  }
  const std::vector<double> slopes = temperature_slopes(population);
  Json& slope = json["distributions"]["temperature_slope_dph_per_k"];
  slope = {{"axes", slopes.size()}};
  if (!slopes.empty()) {
    slope["median"] = statistics::quantile_of_sorted(slopes, 0.5);
    slope["quartiles"] = {statistics::quantile_of_sorted(slopes, 0.25),
                          statistics::quantile_of_sorted(slopes, 0.75)};
  }
  json["effects"] = Json::array();
  for (const EffectCount& effect : population.effects) {
    json["effects"].push_back({{"effect", effect.effect},
                               {"axes", effect.axes},
                               {"sensors", effect.sensors},
                               {"is_common", effect.is_common}});
  }
  json["outliers"] = Json::array();
  for (const Sensor* sensor : outliers(population)) {
    const Reason& reason = sensor->reasons.front();
    json["outliers"].push_back({{"sensor", sensor->name},
                                {"lot", population.lots[sensor->lot].name},
                                {"lot_differs", population.lots[sensor->lot].differs},
                                {"q_value", sensor->q_value},
                                {"reason", reason.name},
                                {"axis", reason.axis},
                                {"recording", reason.recording}});
  }
  json["lots"] = Json::array();
  for (const LotFigure& figure : population.lot_figures) {
    json["lots"].push_back({{"lot", population.lots[figure.lot].name},
                            {"figure", figure.what},
                            {"value", in_unit(figure, figure.lot_value)},
                            {"others", in_unit(figure, figure.other_value)},
                            {"p_value", figure.p_value},
                            {"q_value", population.lots[figure.lot].q_value},
                            {"differs", figure.differs}});
  }
  json["changed"] = Json::array();
  for (const Sensor* sensor : changed(population)) {
    json["changed"].push_back({{"sensor", sensor->name}, {"q_value", sensor->change_q_value}});
  }
  json["bad"] = Json::array();
  for (const StoredRecording& one : population.bad) {
    json["bad"].push_back({{"recording", one.entry.name}, {"problem", one.problem}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_csv(const Population& population) {
  std::string text =
      "recording,sensor,lot,axis,angle_random_walk_dps_per_sqrt_hz,bias_instability_dph,order,"
      "mean_rate_dps,temperature_slope_dph_per_k,verdict,effects,distance_p,sensor_q,outlier\n";
  for (const Member& member : population.members) {
    const StoredRecording& recording = population.recordings[member.recording];
    const AxisResult& axis =
        *std::ranges::find(recording.result.axes, member.axis, &AxisResult::axis);
    const Sensor& sensor = population.sensors[member.sensor];
    const auto maybe = [](const std::optional<double>& value, double per_si) {
      return value ? fmt::format("{:.6g}", *value * per_si) : std::string{};
    };
    std::string effects;
    for (const Cause& cause : axis.causes) effects += (effects.empty() ? "" : " ") + cause.effect;
    text += fmt::format("{},{},{},{},{:.6g},{},{},{:.6g},{},{},{},{:.3g},{:.3g},{}\n",
                        cell_of(recording.entry.name), cell_of(sensor.name),
                        cell_of(population.lots[member.lot].name), member.axis,
                        axis.angle_random_walk_rad_per_sqrt_s * units::kDegPerRad,
                        maybe(axis.bias_instability_rad_s, units::kDphPerRadS),
                        maybe(axis.order, 1.0), axis.mean_rate_rad_s * units::kDegPerRad,
                        maybe(axis.temperature_slope_rad_s_per_k, units::kDphPerRadS), axis.verdict,
                        effects, std::exp(member.evidence.log_p), sensor.q_value,
                        sensor.is_outlier ? 1 : 0);
  }
  return text;
}

report::Report make_report(const Population& population, const std::string& provenance) {
  report::Report report{"Population of a fleet", lead_of(population)};
  report::Section& distributions = report.section("Distributions");
  distributions.table(distribution_table(population));
  for (int i = 0; i < kCoordinates; ++i) distributions.chart(histogram(population, i));
  const std::vector<double> slopes = temperature_slopes(population);
  if (!slopes.empty()) {
    distributions.paragraph(fmt::format(
        "On {} axes the bias follows the temperature: median {:.3g} deg/h/K, half of them between "
        "{:.3g} and {:.3g}.",
        slopes.size(), statistics::quantile_of_sorted(slopes, 0.5),
        statistics::quantile_of_sorted(slopes, 0.25),
        statistics::quantile_of_sorted(slopes, 0.75)));
  }
  if (!population.effects.empty()) {
    report::BarChart bars{.title = "Axes with an effect", .y = {"Axes"}};
    report::BarGroup axes{.name = "Axes"};
    for (const EffectCount& effect : population.effects) {
      bars.categories.push_back(effect.effect);
      axes.values.push_back(static_cast<double>(effect.axes));
    }
    bars.groups.push_back(std::move(axes));
    report.section("Causes").chart(bars).table(effect_table(population));
  }
  report::Section& leaving = report.section("Sensors that leave the population");
  if (outliers(population).empty()) {
    leaving.paragraph("None.");
  } else {
    leaving.table(outlier_table(population));
  }
  if (!population.lot_figures.empty()) report.section("Lots").table(lot_table(population));
  const auto changes = changed(population);
  if (!changes.empty()) {
    report::Table table{.columns = {{"Sensor"}, {"Recordings"}, {"q", "", 6}}};
    for (const Sensor* sensor : changes) {
      table.rows.push_back({sensor->name, sensor->recordings, sensor->change_q_value});
    }
    report.section("Sensors that changed between recordings").table(table);
  }
  if (!population.bad.empty()) {
    report::Table table{.columns = {{"Recording"}, {"Why it was not used"}}};
    for (const StoredRecording& one : population.bad) {
      table.rows.push_back({one.entry.name, one.problem});
    }
    report.section("Recordings that could not be used").table(table);
  }
  report.provenance(provenance);
  return report;
}

}  // namespace zerorate::fleet

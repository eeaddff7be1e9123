// A population to read, to look at, and for other programs.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_tools/lib/fleet/presentation.hpp"
#include "host_tools/lib/statistics/statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::fleet {
namespace {

using Json = nlohmann::ordered_json;

/// Text as a cell of CSV (RFC 4180).
std::string cell_of(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? std::string{"\"\""} : std::string{c};
  return cell + '"';
}

Json index_json(const Index& index) {
  return {{"value", index.value}, {"ci95", {index.lo, index.hi}}};
}

Json quality_json(const Population& population, const Quality& quality) {
  Json json = Json::object();
  if (quality.has_limits) {
    json = {{"passed", quality.passed},
            {"failed", quality.failed},
            {"too_short", quality.too_short},
            {"yield", index_json(quality.yield)}};
  }
  for (const QualityFigure& figure : quality.figures) {
    Json& one = json["figures"][figure.key];
    one["out_of_control"] = Json::array();
    for (const std::size_t place : figure.chart.outside) {
      one["out_of_control"].push_back(population.sensors[quality.order[place]].name);
    }
    if (!figure.capability) continue;
    one["ppk"] = index_json(figure.capability->ppk);
    one["cpk"] = figure.capability->cpk ? index_json(*figure.capability->cpk) : Json(nullptr);
    one["below"] = figure.capability->below;
    one["above"] = figure.capability->above;
  }
  return json;
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
}  // namespace

const std::array<Shown, kCoordinates>& shown() {
  static const std::array<Shown, kCoordinates> all = {
      Shown{"Angle random walk N", "angle_random_walk_dps_per_sqrt_hz", "deg/s/sqrt(Hz)",
            units::kDegPerRad, true},
      Shown{"Bias instability B", "bias_instability_dph", "deg/h", units::kDphPerRadS, true},
      Shown{"Order d", "order", "", 1.0, false}};
  return all;
}

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

LotEffect effect_in_words(const LotFigure& figure) {
  if (figure.what == kCoordinateNames.back()) return *figure.effect;
  return {std::exp(figure.effect->value), std::exp(figure.effect->lo), std::exp(figure.effect->hi)};
}

std::string effect_text(const LotFigure& figure) {
  if (!figure.effect) return {};
  const LotEffect effect = effect_in_words(figure);
  const bool is_order = figure.what == kCoordinateNames.back();
  return fmt::format("{}{:.3g} [{:.3g}, {:.3g}]{}", is_order ? "by " : "", effect.value, effect.lo,
                     effect.hi, is_order ? "" : " times");
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
  const auto unused = static_cast<std::size_t>(std::ranges::count_if(
      population.bad, [](const StoredRecording& one) { return one.result.axes.empty(); }));
  return fmt::format(
      "{} recordings of {} sensors; {} of {} axes make the population. {} sensors leave it, {} of "
      "{} lots differ{} from the reference, {} sensors changed between recordings, {} recordings "
      "could not be used, and {} could in part or after repair. Of the sensors and lots that are "
      "named, some {:.2g} % are named by chance.",
      population.recordings.size(), population.sensors.size(), population.core,
      population.members.size(), outliers(population).size(), bad_lots, population.lots.size(),
      bad_lots == 1 ? "s" : "", changed(population).size(), unused, population.bad.size() - unused,
      100.0 * population.options.false_discovery_rate);
}

std::string to_text(const Population& population) {
  std::string text = lead_of(population) + "\n";
  for (const std::string& warning : population.warnings) text += "warning: " + warning + "\n";
  if (population.quality && population.quality->has_limits) {
    text += words(population, *population.quality) + "\n";
  }
  text += "\n";
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
    if (figure.what == "outliers") {
      text += fmt::format(
          "lot {}: {:.2g} of its sensors leave the population, of the reference {:.2g} (q = "
          "{:.2g})\n",
          population.lots[figure.lot].name, figure.lot_value, figure.other_value,
          population.lots[figure.lot].q_value);
      continue;
    }
    text += fmt::format("lot {}: {} is {:.4g}, of the reference {:.4g}{}{} (q = {:.2g})\n",
                        population.lots[figure.lot].name, figure.what,
                        in_unit(figure, figure.lot_value), in_unit(figure, figure.other_value),
                        figure.effect ? ": " : "", effect_text(figure),
                        population.lots[figure.lot].q_value);
  }
  for (const Sensor* sensor : changed(population)) {
    text += fmt::format("sensor {}: changed between its recordings (q = {:.2g})\n", sensor->name,
                        sensor->change_q_value);
  }
  for (const StoredRecording& one : population.bad) {
    text += fmt::format("{}: {}: {}\n", one.result.axes.empty() ? "not used" : "used with a remark",
                        one.entry.name, one.problem);
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
               {"false_discovery_rate", population.options.false_discovery_rate},
               {"warnings", population.warnings}};
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
  if (population.quality) json["quality"] = quality_json(population, *population.quality);
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
                            {"differs", figure.differs},
                            {"is_reference", population.lots[figure.lot].is_reference}});
    if (!figure.effect) continue;
    const LotEffect effect = effect_in_words(figure);
    Json& lot = json["lots"].back();
    lot[figure.what == kCoordinateNames.back() ? "difference" : "ratio"] = effect.value;
    lot["effect_ci95"] = {effect.lo, effect.hi};
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

}  // namespace zerorate::fleet

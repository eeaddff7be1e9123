// A characterization as files for other programs: JSON and comma-separated values.
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>

#include "host_tools/lib/identify/characterization_report.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using Json = nlohmann::ordered_json;
using recording::number;
using units::kDegPerRad;
using units::kDegRtHPerRadRtS;
using units::kDphPerRadS;
using units::kDphRtHPerRadSRtS;

Json interval(const IntervalEstimate& estimate, double unit) {
  return {{"value", number(estimate.value * unit)},
          {"standard_error", number(estimate.standard_error * unit)},
          {"lo95", number(estimate.lo * unit)},
          {"hi95", number(estimate.hi * unit)}};
}

Json flicker_json(const FittedFlicker& flicker) {
  Json order = interval(flicker.order, 1.0);
  order["source"] = name(flicker.order_source);
  Json json{{"bias_instability_dph", interval(flicker.bias_instability_rad_s, kDphPerRadS)},
            {"order", std::move(order)}};
  if (flicker.rejected_order) json["rejected_order"] = interval(*flicker.rejected_order, 1.0);
  return json;
}

Json allan_json(const std::vector<AllanPoint>& points) {
  Json json = Json::array();
  for (const AllanPoint& point : points) {
    json.push_back({{"tau_s", point.tau_s},
                    {"adev_dph", number(point.adev * kDphPerRadS)},
                    {"lo95_dph", number(point.lo * kDphPerRadS)},
                    {"hi95_dph", number(point.hi * kDphPerRadS)},
                    {"edf", number(point.edf)}});
  }
  return json;
}

Json density_json(const std::vector<DensityBin>& bins) {
  Json json = Json::array();
  for (const DensityBin& bin : bins) {
    json.push_back({{"frequency_hz", bin.frequency_hz},
                    {"density_dps2_per_hz", number(bin.density * kDegPerRad * kDegPerRad)},
                    {"points", bin.points}});
  }
  return json;
}

Json strengths_json(const InnovationsFit& fit) {
  return {{"angle_random_walk_dps_per_sqrt_hz",
           interval(fit.angle_random_walk_rad_per_sqrt_s, kDegPerRad)},
          {"flicker", fit.flicker ? flicker_json(*fit.flicker) : Json(nullptr)}};
}

Json sameness_json(const Characterization& result) {
  Json json{{"recordings", {result.recording}},
            {"size", Sameness::kSize},
            {"serves", true},
            {"axes", Json::object()}};
  for (const std::string& more : result.further_recordings) json["recordings"].push_back(more);
  for (const Sameness& axis : result.sameness) {
    if (!axis.holds()) json["serves"] = false;
    Json alone = Json::array();
    for (const InnovationsFit& fit : axis.alone) alone.push_back(strengths_json(fit));
    json["axes"][axis.axis] = {{"serves", axis.holds()},
                               {"p_value", number(axis.p_value)},
                               {"likelihood_ratio", number(axis.likelihood_ratio)},
                               {"degrees_of_freedom", axis.degrees_of_freedom},
                               {"together", strengths_json(axis.together)},
                               {"alone", std::move(alone)}};
  }
  return json;
}

Json interval(const std::optional<IntervalEstimate>& estimate, double unit) {
  return estimate ? interval(*estimate, unit) : Json(nullptr);
}

void add_walk(Json& json, const std::optional<IntervalEstimate>& walk) {
  json["rate_random_walk_dps_per_sqrt_s"] = interval(walk, kDegPerRad);
  json["rate_random_walk_dph_per_sqrt_h"] = interval(walk, kDphRtHPerRadSRtS);
}

Json coefficients_json(const NoiseCoefficients& coefficients) {
  Json json{{"angle_random_walk_dps_per_sqrt_hz",
             interval(coefficients.angle_random_walk_rad_per_sqrt_s, kDegPerRad)},
            {"bias_instability_dph", interval(coefficients.bias_instability_rad_s, kDphPerRadS)}};
  add_walk(json, coefficients.rate_random_walk_rad_s_per_sqrt_s);
  json["without_flicker"] = nullptr;
  if (const auto& pair = coefficients.without_flicker) {
    json["without_flicker"] = {{"angle_random_walk_dps_per_sqrt_hz",
                                interval(pair->angle_random_walk_rad_per_sqrt_s, kDegPerRad)}};
    add_walk(json["without_flicker"], pair->rate_random_walk_rad_s_per_sqrt_s);
  }
  return json;
}

Json axis_json(const AxisCharacterization& axis) {
  const InnovationsFit& fit = axis.fit;
  Json json{{"angle_random_walk_dps_per_sqrt_hz",
             interval(fit.angle_random_walk_rad_per_sqrt_s, kDegPerRad)},
            {"angle_random_walk_deg_per_sqrt_h",
             interval(fit.angle_random_walk_rad_per_sqrt_s, kDegRtHPerRadRtS)},
            {"flicker", fit.flicker ? flicker_json(*fit.flicker) : Json(nullptr)},
            {"flicker_likelihood_ratio", number(fit.likelihood_ratio)},
            {"flicker_p_value", number(fit.p_value)},
            {"minus_two_log_likelihood", number(fit.minus_two_log_likelihood)},
            {"local_whittle_order", nullptr},
            {"allan_floor", nullptr}};
  if (axis.local_whittle_order) {
    json["local_whittle_order"] = {{"value", axis.local_whittle_order->value},
                                   {"standard_error", axis.local_whittle_order->standard_error}};
  }
  if (!axis.allan.empty()) {
    const AllanPoint& floor = axis.allan_floor();
    json["allan_floor"] = {{"adev_dph", number(floor.adev * kDphPerRadS)},
                           {"lo95_dph", number(floor.lo * kDphPerRadS)},
                           {"hi95_dph", number(floor.hi * kDphPerRadS)},
                           {"tau_s", floor.tau_s}};
  }
  json["coefficients"] = coefficients_json(axis.coefficients);
  json["remarks"] = axis.remarks;
  json["allan_deviation"] = allan_json(axis.allan);
  json["density"] = density_json(axis.density);
  return json;
}

}  // namespace

std::string_view name(OrderSource source) {
  switch (source) {
    case OrderSource::given:
      return "given";
    case OrderSource::estimated:
      return "estimated";
    case OrderSource::prior:
      return "prior";
    case OrderSource::limit:
      return "limit";
  }
  return "unknown";
}

std::string to_json(const Characterization& result) {
  Json json{{"schema", "zerorate.characterization/1"},
            {"recording", result.recording},
            {"rows", result.rows},
            {"rows_moving", result.rows_moving},
            {"rows_lost", result.rows_lost},
            {"rows_wild", result.rows_wild},
            {"rows_repeated", result.rows_repeated},
            {"rows_outlying", result.rows_outlying},
            {"rows_left_out", result.findings.left_out()},
            {"rows_doubt", recording::doubt_of_rows(result.findings)},
            {"findings", recording::to_json(result.findings)},
            {"doubts", result.doubts},
            {"sample_period_s", static_cast<double>(result.sample_period.ns()) * 1e-9},
            {"tick_s", static_cast<double>(result.tick.ns()) * 1e-9},
            {"ticks", result.ticks},
            {"rest_s", result.rest_s},
            {"middle_axis", middle_axis(result).axis},
            {"axes", Json::object()}};
  for (const AxisCharacterization& axis : result.axes) json["axes"][axis.axis] = axis_json(axis);
  if (!result.sameness.empty()) json["one_parameter_set"] = sameness_json(result);
  // A name may be no UTF-8: what is none is replaced.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string allan_csv(const Characterization& result) {
  std::string csv = "axis,tau_s,adev_dps,lo95_dps,hi95_dps\n";
  for (const AxisCharacterization& axis : result.axes) {
    for (const AllanPoint& point : axis.allan) {
      csv += fmt::format("{},{:.6g},{:.6g},{:.6g},{:.6g}\n", axis.axis, point.tau_s,
                         point.adev * kDegPerRad, point.lo * kDegPerRad, point.hi * kDegPerRad);
    }
  }
  return csv;
}

}  // namespace zerorate::identify

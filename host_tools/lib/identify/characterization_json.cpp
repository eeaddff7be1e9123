#include "host_tools/lib/identify/characterization_json.hpp"

#include <nlohmann/json.hpp>

#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::identify {
namespace {

using Json = nlohmann::ordered_json;
using recording::number;

using units::kDegPerRad;
using units::kDegRtHPerRadRtS;
using units::kDphPerRadS;

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
    json["allan_floor"] = {{"adev_dph", number(floor.adev * kDphPerRadS)}, {"tau_s", floor.tau_s}};
  }
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
            {"findings", recording::to_json(result.findings)},
            {"sample_period_s", static_cast<double>(result.sample_period.ns()) * 1e-9},
            {"tick_s", static_cast<double>(result.tick.ns()) * 1e-9},
            {"ticks", result.ticks},
            {"rest_s", result.rest_s},
            {"middle_axis", middle_axis(result).axis},
            {"axes", Json::object()}};
  for (const AxisCharacterization& axis : result.axes) json["axes"][axis.axis] = axis_json(axis);
  return json.dump(2) + "\n";
}

}  // namespace zerorate::identify

#include "host_tools/lib/identify/characterization_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace zerorate::identify {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kDphPerRadS = 3600.0 * kDegPerRad;
constexpr double kDegRtHPerRadRtS = 60.0 * kDegPerRad;

/// JSON has no infinity.
Json figure(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json interval(const IntervalEstimate& estimate, double unit) {
  return {{"value", figure(estimate.value * unit)},
          {"standard_error", figure(estimate.standard_error * unit)},
          {"lo95", figure(estimate.lo * unit)},
          {"hi95", figure(estimate.hi * unit)}};
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
                    {"adev_dph", figure(point.adev * kDphPerRadS)},
                    {"lo95_dph", figure(point.lo * kDphPerRadS)},
                    {"hi95_dph", figure(point.hi * kDphPerRadS)},
                    {"edf", figure(point.edf)}});
  }
  return json;
}

Json density_json(const std::vector<DensityBin>& bins) {
  Json json = Json::array();
  for (const DensityBin& bin : bins) {
    json.push_back({{"frequency_hz", bin.frequency_hz},
                    {"density_dps2_per_hz", figure(bin.density * kDegPerRad * kDegPerRad)},
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
            {"flicker_likelihood_ratio", figure(fit.likelihood_ratio)},
            {"flicker_p_value", figure(fit.p_value)},
            {"minus_two_log_likelihood", figure(fit.minus_two_log_likelihood)},
            {"local_whittle_order", nullptr},
            {"allan_floor", nullptr}};
  if (axis.local_whittle_order) {
    json["local_whittle_order"] = {{"value", axis.local_whittle_order->value},
                                   {"standard_error", axis.local_whittle_order->standard_error}};
  }
  if (!axis.allan.empty()) {
    const AllanPoint& floor = axis.allan_floor();
    json["allan_floor"] = {{"adev_dph", figure(floor.adev * kDphPerRadS)}, {"tau_s", floor.tau_s}};
  }
  json["remarks"] = axis.remarks;
  json["allan_deviation"] = allan_json(axis.allan);
  json["density"] = density_json(axis.density);
  return json;
}

Json findings_json(const recording::Findings& findings) {
  Json json = Json::object();
  for (std::size_t i = 0; i < recording::kFindingCount; ++i) {
    const auto finding = static_cast<recording::Finding>(i);
    if (findings.count(finding) == 0) continue;
    json[std::string(recording::description(finding))] = {
        {"rows", findings.count(finding)}, {"first_line", findings.first_line(finding)}};
  }
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
            {"findings", findings_json(result.findings)},
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

#include "host_tools/lib/diagnose/presentation/presentation.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using Json = nlohmann::ordered_json;
using recording::number;

constexpr std::string_view kSchema = "zerorate.diagnosis/1";

void add(Json& json, const std::string& name, double value, double lo, double hi) {
  json[name] = number(value);
  json[name + "_ci95"] = {number(lo), number(hi)};
}

void add(Json& json, const std::string& name, const BootstrapFigure& estimate) {
  add(json, name, estimate.value, estimate.lo, estimate.hi);
}

Json cause_json(const Cause& cause) {
  Json json{{"name", cause.effect},
            {"gain_nats", number(cause.gain_nats)},
            {"p_value", number(cause.p_value)},
            {"axes", cause.axes},
            {"probability", number(cause.probability)},
            {"stands_alone", cause.stands_alone()},
            {"set95", Json::array()},
            {"in_model", cause.in_model},
            {"parameters", Json::object()},
            {"alternatives", Json::array()}};
  if (!cause.in_model) json["left_out_because"] = cause.left_out_because;
  if (cause.heading_drift_ratio) {
    add(json, "heading_drift_ratio", *cause.heading_drift_ratio);
  } else {
    json["heading_drift_ratio"] = nullptr;
  }
  for (const Explanation& one : cause.set95) {
    json["set95"].push_back({{"name", one.effect}, {"probability", number(one.probability)}});
  }
  for (const Parameter& parameter : cause.parameters) {
    add(json["parameters"], parameter.name, parameter.value, parameter.lo, parameter.hi);
  }
  for (const Alternative& rival : cause.alternatives) {
    json["alternatives"].push_back(
        {{"name", rival.effect}, {"less_likely_by_nats", number(rival.less_likely_by_nats)}});
  }
  return json;
}

Json misfit_json(const std::vector<Misfit>& rows) {
  Json json = Json::array();
  for (const Misfit& row : rows) {
    if (!row.is_outside()) continue;
    json.push_back({{"statistic", row.statistic},
                    {"where", row.where},
                    {"measured", number(row.measured)},
                    {"simulated_lo", number(row.simulated_lo)},
                    {"simulated_hi", number(row.simulated_hi)}});
  }
  return json;
}

Json adequacy_json(const Adequacy& adequacy) {
  return {{"holds", adequacy.holds},
          {"p_value", number(adequacy.p_value)},
          {"failures", adequacy.failures}};
}

Json gain_json(const Gain& gain) {
  Json json{{"holdout_samples", gain.holdout_samples}};
  add(json, "rsse_ratio", gain.rsse_ratio);
  add(json, "ie_ratio", gain.ie_ratio);
  add(json, "heading_drift_ratio", gain.heading_drift_ratio);
  add(json, "coverage95_base", gain.coverage95_base);
  add(json, "coverage95_extended", gain.coverage95_extended);
  add(json, "log_score_gain_nats_per_sample", gain.log_score_gain_nats_per_sample);
  return json;
}

Json or_null(std::optional<bool> value) {
  return value ? Json(*value) : Json();
}

Json remainder_json(const Diagnosis& axis) {
  Json json = Json::array();
  if (!axis.materiality) return json;
  for (const HeadingExcess& excess : axis.materiality->by_drive) {
    json.push_back({{"drive_s", number(excess.drive_s)}, {"drives", excess.drives}});
    add(json.back(), "heading_error_ratio", excess.ratio);
    json.back()["material"] = or_null(excess.is_material());
  }
  return json;
}

Json axis_json(const Diagnosis& axis) {
  Json json{{"schema", kSchema},
            {"axis", axis.axis},
            {"verdict", name(axis.verdict)},
            {"material", or_null(axis.is_material())},
            {"remainder", remainder_json(axis)},
            {"causes", Json::array()},
            {"further_causes", Json::array()},
            {"misfit", misfit_json(axis.misfit)},
            {"adequacy",
             {{"base", adequacy_json(axis.base_adequacy)},
              {"extended", adequacy_json(axis.extended_adequacy)}}},
            {"gain", gain_json(axis.gain)},
            {"gain_over_data_sheet", gain_json(axis.gain_over_data_sheet)}};
  for (std::size_t i = 0; i < axis.causes.size(); ++i) {
    json[i < kMostCauses ? "causes" : "further_causes"].push_back(cause_json(axis.causes[i]));
  }
  return json;
}

Json figures_json(const odometry::OdometerFinding& finding) {
  Json figures = Json::object();
  for (const auto& [name, figure] : finding.figures) {
    const bool has_interval = std::isfinite(figure.lo) && std::isfinite(figure.hi);
    if (has_interval) {
      add(figures, name, figure);
    } else {
      figures[name] = number(figure.value);
    }
  }
  return figures;
}

Json odometer_json(const odometry::OdometerDiagnosis& odometer) {
  Json json{{"findings", Json::array()}, {"configuration", odometer.configuration}};
  for (const odometry::OdometerFinding& finding : odometer.findings) {
    json["findings"].push_back({{"name", finding.name},
                                {"sentence", finding.sentence},
                                {"figures", figures_json(finding)}});
  }
  if (odometer.gain) {
    const odometry::HeadingGain& gain = *odometer.gain;
    json["gain"] = {{"drives", gain.drives},
                    {"heading_rms_deg_every_stop", gain.every_stop_rms_rad * units::kDegPerRad},
                    {"coverage95_every_stop", gain.every_stop_coverage95},
                    {"heading_rms_deg_calm", gain.calm_rms_rad * units::kDegPerRad},
                    {"coverage95_calm", gain.calm_coverage95}};
  }
  return json;
}

Json drive_gain_json(const DriveGain& gain) {
  Json json{{"drives_fitted", gain.fitted}, {"drives_held_out", gain.held_out}};
  add(json, "heading_rms_before_deg", gain.rms_before_deg);
  add(json, "heading_rms_after_deg", gain.rms_after_deg);
  add(json, "heading_rms_ratio", gain.rms_ratio);
  add(json, "coverage95_before", gain.coverage95_before);
  add(json, "coverage95_after", gain.coverage95_after);
  add(json, "log_score_gain_nats_per_drive", gain.log_score_nats_per_drive);
  return json;
}

Json drives_json(const DriveDiagnosis& drives) {
  const bool is_examined = drives.obstacle.empty();
  Json json{{"obstacle", is_examined ? Json() : Json(drives.obstacle)},
            {"verdict", is_examined ? Json(name(drives.verdict)) : Json()},
            {"vertical_axis", drives.vertical},
            {"drives", drives.drives},
            {"left_out", drives.left_out},
            {"heading_rms_deg", number(drives.rms_rad * units::kDegPerRad)},
            {"heading_rms_left_deg", number(drives.rms_left_rad * units::kDegPerRad)},
            {"scatter_over_expected", number(drives.scatter)},
            {"causes", Json::array()},
            {"gain", drive_gain_json(drives.gain)},
            {"remarks", drives.remarks}};
  for (const Cause& cause : drives.causes) json["causes"].push_back(cause_json(cause));
  return json;
}

Json costs_json(std::span<const Diagnosis> axes, const DriveDiagnosis& drives) {
  Json json = Json::array();
  for (const Cost& cost : causes_by_cost(axes, drives)) {
    const auto& ratio = cost.cause->heading_drift_ratio;
    json.push_back({{"name", cost.cause->effect},
                    {"where", cost.where},
                    {"heading_drift_ratio", ratio ? number(ratio->value) : Json()}});
  }
  return json;
}

}  // namespace

std::string to_json(std::span<const Diagnosis> axes, const std::vector<std::string>& doubts,
                    const odometry::OdometerDiagnosis* odometer, const DriveDiagnosis* drives) {
  Json json;
  if (axes.size() == 1) {
    json = axis_json(axes.front());
  } else {
    json = {{"schema", kSchema}, {"axes", Json::array()}};
    for (const Diagnosis& axis : axes) json["axes"].push_back(axis_json(axis));
  }
  json["doubts"] = doubts;
  if (drives != nullptr) {
    json["drives"] = drives_json(*drives);
    json["causes_by_cost"] = costs_json(axes, *drives);
  }
  if (odometer != nullptr) json["odometer"] = odometer_json(*odometer);
  return json.dump(2) + "\n";
}

}  // namespace zerorate::diagnose

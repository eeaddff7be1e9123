#include "host_tools/lib/diagnose/diagnosis_json.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

namespace zerorate::diagnose {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kSchema = "zerorate.diagnosis/1";

/// JSON has neither infinity nor NaN.
Json figure(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

void add(Json& json, const std::string& name, double value, double lo, double hi) {
  json[name] = figure(value);
  json[name + "_ci95"] = {figure(lo), figure(hi)};
}

void add(Json& json, const std::string& name, const IntervalEstimate& estimate) {
  add(json, name, estimate.value, estimate.lo, estimate.hi);
}

Json cause_json(const Cause& cause) {
  Json json{{"name", cause.effect},
            {"gain_nats", figure(cause.gain_nats)},
            {"p_value", figure(cause.p_value)},
            {"parameters", Json::object()},
            {"alternatives", Json::array()}};
  for (const Parameter& parameter : cause.parameters) {
    add(json["parameters"], parameter.name, parameter.value, parameter.lo, parameter.hi);
  }
  for (const Alternative& rival : cause.alternatives) {
    json["alternatives"].push_back(
        {{"name", rival.effect}, {"behind_nats", figure(rival.behind_nats)}});
  }
  return json;
}

Json misfit_json(const std::vector<Misfit>& rows) {
  Json json = Json::array();
  for (const Misfit& row : rows) {
    if (!row.is_outside()) continue;
    json.push_back({{"statistic", row.statistic},
                    {"where", row.where},
                    {"measured", figure(row.measured)},
                    {"simulated_lo", figure(row.simulated_lo)},
                    {"simulated_hi", figure(row.simulated_hi)}});
  }
  return json;
}

Json adequacy_json(const Adequacy& adequacy) {
  return {{"holds", adequacy.holds},
          {"p_value", figure(adequacy.p_value)},
          {"failures", adequacy.failures}};
}

/// Without samples that were held out nothing was measured.
Json gain_json(const Gain& gain) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  Json json{{"holdout_samples", gain.holdout_samples}};
  const auto add_measured = [&](const char* name, const IntervalEstimate& estimate) {
    add(json, name,
        gain.holdout_samples > 0 ? estimate
                                 : IntervalEstimate{kUnknown, kUnknown, kUnknown, kUnknown});
  };
  add_measured("rsse_ratio", gain.rsse_ratio);
  add_measured("ie_ratio", gain.ie_ratio);
  add_measured("heading_drift_ratio", gain.heading_drift_ratio);
  add_measured("coverage95_base", gain.coverage95_base);
  add_measured("coverage95_extended", gain.coverage95_extended);
  add_measured("log_score_gain_nats_per_sample", gain.log_score_gain_nats_per_sample);
  return json;
}

Json axis_json(const Diagnosis& axis) {
  Json json{{"schema", kSchema},
            {"axis", axis.axis},
            {"verdict", name(axis.verdict)},
            {"causes", Json::array()},
            {"misfit", misfit_json(axis.misfit)},
            {"adequacy",
             {{"base", adequacy_json(axis.base_adequacy)},
              {"extended", adequacy_json(axis.extended_adequacy)}}},
            {"gain", gain_json(axis.gain)}};
  for (const Cause& cause : axis.causes) json["causes"].push_back(cause_json(cause));
  return json;
}

}  // namespace

std::string to_json(std::span<const Diagnosis> axes) {
  if (axes.size() == 1) return axis_json(axes.front()).dump(2) + "\n";
  Json json{{"schema", kSchema}, {"axes", Json::array()}};
  for (const Diagnosis& axis : axes) json["axes"].push_back(axis_json(axis));
  return json.dump(2) + "\n";
}

}  // namespace zerorate::diagnose

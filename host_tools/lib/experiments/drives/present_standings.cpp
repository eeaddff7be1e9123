#include "host_tools/lib/experiments/drives/present_standings.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::experiments {

using recording::number;
using units::kDegPerRad;
using units::kDphPerRadS;

std::string label(const evaluate::ScheduleParams& schedule) {
  return fmt::format("{:g}/{:g}", schedule.still_s, schedule.drive_s);
}

std::string axis_label(std::size_t axis) {
  return std::string(1, "xyz"[axis]);
}

void append(std::vector<report::Cell>& row, const BootstrapFigure& figure) {
  for (const double value : {figure.value, figure.lo, figure.hi}) row.emplace_back(value);
}

void add(nlohmann::ordered_json& into, const std::string& key, const BootstrapFigure& figure) {
  into[key] = number(figure.value);
  into[key + "_ci95"] = {number(figure.lo), number(figure.hi)};
}

nlohmann::ordered_json to_json(const DriveStanding& standing) {
  nlohmann::ordered_json json{{"heading_drift_rms_deg", number(standing.drift_rms_deg)}};
  add(json, "ratio_to_calibration_mean", standing.ratio);
  add(json, "coverage95", standing.coverage);
  json["sigma_over_rms"] = number(standing.sigma_over_rms);
  return json;
}

report::Table fits_table(const std::vector<DriveContest::AxisModels>& fits) {
  report::Table table{.caption = "Noise fitted to each recording, for use as the options say",
                      .columns = {{"recording"},
                                  {"axis"},
                                  {"N", "deg/s/sqrt(Hz)", 4},
                                  {"B", "deg/h", 1},
                                  {"d", "", 3},
                                  {"B at d = 1/2", "deg/h", 1}}};
  for (const auto& fit : fits) {
    const auto& free = fit.extended;
    const double b = free.flicker ? free.flicker->bias_instability_rad_s * kDphPerRadS : 0.0;
    const auto& half = fit.base.flicker;
    table.rows.push_back({fit.recording, axis_label(fit.axis),
                          free.white.angle_random_walk_rad_per_sqrt_s * kDegPerRad, b,
                          free.flicker ? free.flicker->order : std::nan(""),
                          half ? half->bias_instability_rad_s * kDphPerRadS : 0.0});
  }
  return table;
}

}  // namespace zerorate::experiments

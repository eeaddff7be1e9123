#include "host_tools/lib/evaluate/replay_json.hpp"

#include <nlohmann/json.hpp>

#include "host_tools/lib/evaluate/learnt_model.hpp"
#include "host_tools/lib/evaluate/true_drives_report.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::evaluate {
namespace {

using Json = nlohmann::ordered_json;
using recording::number;

using units::kDegPerRad;

/// Scores of an axis; those of its drives need a true rate.
Json scores_json(const DriveScores& scores, const DriveScores& baseline, const StopScores& stops,
                 bool is_truth_known) {
  const statistics::BootstrapFigure ratio = drift_ratio(scores, baseline);
  const auto of_drives = [&](double figure) {
    return is_truth_known ? number(figure) : Json(nullptr);
  };
  return {{"stops", stops.stops()},
          {"stop_measured_s", number(stops.measured_s())},
          {"stop_error_rms_dph", number(stops.error_rms_rad_s() * units::kDphPerRadS)},
          {"stop_error_rms_sigmas", number(stops.error_rms_sigmas())},
          {"stop_coverage95", number(stops.coverage95())},
          {"drives", scores.drives()},
          {"heading_drift_rms_deg", of_drives(scores.heading_drift_rms_rad() * kDegPerRad)},
          {"ratio_to_calibration_mean",
           of_drives(scores.heading_drift_rms_rad() / baseline.heading_drift_rms_rad())},
          {"ratio_to_calibration_mean_ci95", {of_drives(ratio.lo), of_drives(ratio.hi)}},
          {"coverage95", of_drives(scores.coverage95())},
          {"sigma_over_rms", of_drives(scores.sigma_over_rms())},
          {"rsse_dps", of_drives(scores.mean_rsse_rad_s() * kDegPerRad)},
          {"ie_deg", of_drives(scores.mean_integrated_rad() * kDegPerRad)}};
}

Json learnt_motion_json(const LearntMotion& learnt) {
  constexpr double kPercent = 100.0;
  return {{"scale_factor_error_percent", number(learnt.scale_factor * kPercent)},
          {"scale_factor_sigma_percent", number(learnt.scale_factor_sigma * kPercent)},
          {"offset_in_motion_dps", number(learnt.offset_rad_s * kDegPerRad)},
          {"offset_in_motion_sigma_dps", number(learnt.offset_sigma_rad_s * kDegPerRad)},
          {"quality", number(learnt.quality)},
          {"references_learnt", learnt.learnt},
          {"references_refused", learnt.refused},
          {"references_unusable", learnt.unusable}};
}

}  // namespace

std::string axis_name(const ReplayResult& result, std::size_t axis) {
  return result.axis_count == 1 ? "rate" : std::string(1, "xyz"[axis]);
}

std::string to_json(const ReplayResult& result, const std::vector<std::size_t>& axes) {
  Json json{
      {"schema", "zerorate.replay/1"},
      {"model", result.model},
      {"model_chosen", result.is_model_chosen},
      {"rows", result.rows},
      {"rows_corrected", result.rows_corrected},
      {"rows_left_out", result.findings.left_out()},
      {"rows_doubt", recording::doubt_of_rows(result.findings)},
      {"samples_refused", result.samples_refused},
      {"samples_saturated", result.samples_saturated},
      {"samples_inconsistent", result.samples_inconsistent},
      {"first_inconsistent_s",
       result.samples_inconsistent > 0 ? Json(result.first_inconsistent_s) : Json(nullptr)},
      {"samples_doubted", result.samples_doubted},
      {"samples_without_temperature", result.samples_without_temperature},
      {"samples_without_acceleration", result.samples_without_acceleration},
      {"samples_frozen", result.samples_frozen},
      {"first_frozen_s", result.samples_frozen > 0 ? Json(result.first_frozen_s) : Json(nullptr)},
      {"samples_disagreeing", result.samples_disagreeing},
      {"sample_period_s", static_cast<double>(result.sample_period.ns()) * 1e-9},
      {"filter_tick_s", static_cast<double>(result.filter_tick.ns()) * 1e-9},
      {"truth_known", result.truth_known},
      {"doubts", result.rest_doubts},
      {"findings", recording::to_json(result.findings)},
      {"axes", Json::object()}};
  for (const std::size_t axis : axes) {
    Json predictors = Json::object();
    const auto& scores = result.scores[axis];
    for (std::size_t p = 0; p < app::kPredictors; ++p) {
      predictors[std::string(name(kAllPredictors[p]))] =
          scores_json(scores[p], scores.back(), result.stop_scores[axis][p], result.truth_known);
    }
    Json& of_axis = json["axes"][axis_name(result, axis)];
    of_axis["predictors"] = std::move(predictors);
    of_axis["learnt"] =
        result.learnt ? learnt_json(learnt_model((*result.learnt)[axis], result.mesh)) : nullptr;
  }
  if (result.learnt_motion) json["learnt_motion"] = learnt_motion_json(*result.learnt_motion);
  if (result.true_drives) {
    json["true_drives"] = true_drives_json(*result.true_drives, result.axis_count);
  }
  return json.dump(2) + "\n";
}

}  // namespace zerorate::evaluate

#include "host_tools/lib/evaluate/true_drives_json.hpp"

#include <nlohmann/json.hpp>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::evaluate {
namespace {

using Json = nlohmann::ordered_json;
using recording::number;
using units::kDegPerRad;
using units::seconds;

Json score_json(const TrueScore& score) {
  return {{"drives", score.drives},
          {"heading_error_rms_deg", number(score.rms_rad * kDegPerRad)},
          {"heading_error_median_deg", number(score.median_rad * kDegPerRad)},
          {"heading_error_worst_deg", number(score.worst_rad * kDegPerRad)},
          {"coverage95", number(score.coverage95)},
          {"coverage95_of_node", number(score.coverage95_of_node)},
          {"sigma_over_rms", number(score.sigma_over_rms)}};
}

Json drive_json(const ScoredDrive& scored) {
  Json json{{"from_s", seconds(scored.drive.from_ns)},
            {"departure_s", seconds(scored.drive.departure_ns)},
            {"to_s", seconds(scored.drive.to_ns)},
            {"flaw", scored.flaw == truth::Flaw::none ? Json(nullptr)
                                                      : Json(std::string(name(scored.flaw)))}};
  if (scored.flaw != truth::Flaw::none) return json;
  json["turn_deg"] = number(scored.drive.turn_rad * kDegPerRad);
  for (const app::Predictor predictor : kAllPredictors) {
    const DriveOutcome& outcome = scored.outcomes[static_cast<std::size_t>(predictor)];
    json["predictors"][std::string(name(predictor))] = {
        {"heading_error_deg", number(outcome.drift_rad * kDegPerRad)},
        {"sigma_deg", number(outcome.sigma_rad * kDegPerRad)}};
  }
  return json;
}

}  // namespace

Json true_drives_json(const TrueDrives& drives, std::size_t axis_count) {
  const truth::Truth& truth = drives.truth;
  Json stops = Json::array();
  for (const truth::Stop& stop : truth.stops) {
    stops.push_back({{"from_s", seconds(stop.from_ns)}, {"to_s", seconds(stop.to_ns)}});
  }
  Json list = Json::array();
  for (const ScoredDrive& scored : drives.drives) list.push_back(drive_json(scored));
  Json predictors = Json::object();
  for (const app::Predictor predictor : kAllPredictors) {
    predictors[std::string(name(predictor))] = score_json(drives.score(predictor));
  }
  const bool is_scored = truth.obstacle.empty();
  return {{"obstacle", is_scored ? Json(nullptr) : Json(truth.obstacle)},
          {"vertical_axis", is_scored ? Json(name(truth.vertical, axis_count)) : Json(nullptr)},
          {"turns_ratio", is_scored ? number(truth.vertical.turns_ratio) : Json(nullptr)},
          {"speed_noise_mps", number(truth.speed_noise_m_s)},
          {"speed_limit_mps", number(truth.speed_limit_m_s)},
          {"reference_error_deg", number(truth.reference_error_rad * kDegPerRad)},
          {"reference_error_at_stops_deg", number(truth.error_at_stops_rad * kDegPerRad)},
          {"scored", drives.scored()},
          {"predictors", std::move(predictors)},
          {"stops", std::move(stops)},
          {"drives", std::move(list)}};
}

}  // namespace zerorate::evaluate

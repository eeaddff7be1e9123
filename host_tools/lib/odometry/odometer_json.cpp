#include "host_tools/lib/odometry/odometer_json.hpp"

#include <nlohmann/json.hpp>
#include <span>

#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/statistics/order_statistics.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::odometry {
namespace {

using Json = nlohmann::ordered_json;
using recording::number;

Json interval(const BootstrapFigure& figure) {
  return {
      {"value", number(figure.value)}, {"lo95", number(figure.lo)}, {"hi95", number(figure.hi)}};
}

Json optional_number(const std::optional<double>& value) {
  return value ? number(*value) : Json(nullptr);
}

/// Quantiles at 0, 0.05, ... 1.
Json quantiles(std::span<const double> sorted, double unit = 1.0) {
  Json json = Json::array();
  if (sorted.empty()) return json;
  for (int i = 0; i <= 20; ++i) {
    json.push_back(number(statistics::quantile_of_sorted(sorted, i / 20.0) * unit));
  }
  return json;
}

Json sample(const Sample& values) {
  return {{"count", values.sorted.size()},
          {"median", interval(values.median)},
          {"quantiles", quantiles(values.sorted)}};
}

Json rolling_json(const Rolling& rolling) {
  return {{"rows", rolling.rows},
          {"share", interval(rolling.share)},
          {"speed_mps", quantiles(rolling.speeds_m_s)},
          {"turning_dps", quantiles(rolling.turning_rad_s, units::kDegPerRad)}};
}

}  // namespace

std::string to_json(const SpeedRecord& record, const OdometerFigures& figures) {
  Json json{
      {"schema", "zerorate.odometer/1"},
      {"recording", record.name},
      {"rows", record.size()},
      {"rows_lost", record.rows_lost},
      {"gaps", record.gap_before.size()},
      {"period_s", figures.rows_s},
      {"duration_s", figures.duration_s},
      {"metres_per_pulse", record.counts_pulses ? number(record.metres_per_pulse) : Json(nullptr)},
      {"smallest_mps", optional_number(figures.smallest_m_s)},
      {"step_mps", optional_number(figures.step_m_s)},
      {"leaves_zero_mps", sample(figures.leaves_zero_m_s)},
      {"reaches_zero_mps", sample(figures.reaches_zero_m_s)},
      {"holds_s", sample(figures.holds_s)},
      {"renewal_s", sample(figures.renewal_s)},
      {"latency_s", interval(figures.latency_s)},
      {"scale", interval(figures.scale)},
      {"silent_share", figures.silent_share},
      {"rolling", rolling_json(figures.rolling)},
      {"rolling_by_situation", Json::object()}};
  for (std::size_t i = 0; i < kSituations.size(); ++i) {
    json["rolling_by_situation"][name(kSituations[i])] =
        rolling_json(figures.rolling_by_situation[i]);
  }
  json["standing_turning_dps"] = quantiles(figures.standing_turning_rad_s, units::kDegPerRad);
  json["true_stops_s"] = sample(figures.true_stops_s);
  json["odometer_stops_s"] = sample(figures.odometer_stops_s);
  json["true_drives_s"] = sample(figures.true_drives_s);
  json["odometer_drives_s"] = sample(figures.odometer_drives_s);
  json["acceleration_mps2"] = quantiles(figures.accelerations_m_s2);
  json["braking_mps2"] = sample(figures.braking_m_s2);
  json["pulling_away_mps2"] = sample(figures.pulling_away_m_s2);
  return json.dump(2) + "\n";
}

}  // namespace zerorate::odometry

#include "host_tools/lib/evaluate/model_table.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "firmware/model/node_model.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/evaluate/simulated_drive.hpp"
#include "host_tools/lib/recording/json.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/recording/row_source.hpp"
#include "host_tools/lib/spectrum/noise_strength.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::evaluate {
namespace {

using units::kDegPerRad;

/// Rates of a sensor at rest, as those of a vehicle that stops and drives straight on.
class StopsAndDrives final : public recording::RowSource {
 public:
  StopsAndDrives(const model::SensorModel& model, const StopAndGo& traffic)
      : traffic_(traffic),
        rest_(simulate_rest({.model = model,
                             .duration_s = (traffic.stop_s + traffic.drive_s) *
                                               static_cast<double>(traffic.drives) +
                                           traffic.stop_s,
                             .sample_rate_hz = traffic.sample_rate_hz,
                             .seed = traffic.seed})) {}

  [[nodiscard]] const recording::Columns& columns() const override { return columns_; }
  [[nodiscard]] bool next(recording::Row& row) override {
    if (next_ == rest_[0].size()) return false;
    const double time_s = static_cast<double>(next_) / traffic_.sample_rate_hz;
    row.time_ns = std::llround(1e9 * time_s);
    row.still = std::fmod(time_s, traffic_.stop_s + traffic_.drive_s) < traffic_.stop_s;
    for (std::size_t axis = 0; axis < rest_.size(); ++axis) {
      row.rate_rad_s.at(axis) = static_cast<float>(rest_.at(axis)[next_]);
    }
    ++next_;
    return true;
  }
  [[nodiscard]] std::uint64_t line() const override { return next_ + 1; }
  [[nodiscard]] std::optional<double> fraction_read() const override {
    return static_cast<double>(next_) / static_cast<double>(rest_[0].size());
  }

 private:
  StopAndGo traffic_;
  recording::Columns columns_{.still = true};
  std::array<std::vector<double>, 3> rest_;
  std::size_t next_ = 0;
};

/// Root mean square of the drifts of the node's own predictor over all axes, and its error.
void simulate(ModelFigures& figures, const model::SensorModel& model, const StopAndGo& traffic) {
  recording::Reader reader{std::make_unique<StopsAndDrives>(model, traffic), figures.name};
  const ReplayResult result =
      replay(reader, {.model = model},
             {.true_rate = [](std::uint64_t) { return std::array<float, 3>{}; }});
  double squares = 0.0;
  double drives = 0.0;
  for (const auto& axis : result.scores) {
    const auto& scores = axis.at(static_cast<std::size_t>(app::Predictor::kalman));
    for (const double drift_rad : scores.drifts_rad()) {
      squares += drift_rad * drift_rad;
      drives += 1.0;
    }
  }
  figures.drift_rms_deg = std::sqrt(squares / drives) * kDegPerRad;
  figures.drift_error_deg = figures.drift_rms_deg / std::sqrt(2.0 * drives);
}

std::string basis_of(std::string_view source) {
  if (source.starts_with("Estimated") || source.starts_with("Not in the data sheet")) {
    return "estimated";
  }
  return source.starts_with("Second-hand") ? "second-hand" : "stated";
}

}  // namespace

ModelFigures figures_of(std::string name, const model::SensorModel& model,
                        const StopAndGo& traffic) {
  ModelFigures figures{.name = std::move(name),
                       .title = model.name,
                       .angle_random_walk_deg_rt_h =
                           model.white.angle_random_walk_rad_per_sqrt_s * units::kDegRtHPerRadRtS};
  if (model.flicker) {
    figures.allan_floor_dph =
        spectrum::allan_floor(model.flicker->bias_instability_rad_s) * units::kDphPerRadS;
    figures.basis = basis_of(model.flicker->source);
  }
  if (model.scale_factor) figures.scale_percent = 100.0 * model.scale_factor->sigma;
  for (const model::Input& input : model.inputs) {
    if (input.quantity != model::InputQuantity::acceleration) continue;
    figures.g_sensitivity_dps_per_g = input.sigma_rad_s_per_unit * kDegPerRad;
  }
  simulate(figures, model::without_accelerometer(model), traffic);
  return figures;
}

report::Presentation present(const std::vector<ModelFigures>& models, const StopAndGo& traffic) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  report::Table table{.caption = "Smaller is better in every column",
                      .columns = {{"model"},
                                  {"angle random walk", "deg/sqrt(h)", 3},
                                  {"bias instability", "deg/h", 1},
                                  {"which is"},
                                  {"drift", "deg", 2},
                                  {"scale", "%", 1},
                                  {"acceleration", "deg/s/g", 3}}};
  nlohmann::ordered_json json{{"schema", "zerorate.models/1"},
                              {"stop_s", traffic.stop_s},
                              {"drive_s", traffic.drive_s},
                              {"drives", traffic.drives},
                              {"models", nlohmann::ordered_json::array()}};
  for (const ModelFigures& model : models) {
    const double scale = model.scale_percent.value_or(kNone);
    const double acceleration = model.g_sensitivity_dps_per_g.value_or(kNone);
    table.rows.push_back({model.name, model.angle_random_walk_deg_rt_h, model.allan_floor_dph,
                          model.basis, model.drift_rms_deg, scale, acceleration});
    json["models"].push_back(
        {{"name", model.name},
         {"title", model.title},
         {"angle_random_walk_deg_per_sqrt_h", model.angle_random_walk_deg_rt_h},
         {"allan_floor_dph", model.allan_floor_dph},
         {"allan_floor_basis", model.basis},
         {"heading_drift_rms_deg", model.drift_rms_deg},
         {"heading_drift_rms_error_deg", model.drift_error_deg},
         {"scale_factor_sigma_percent", recording::number(scale)},
         {"g_sensitivity_sigma_dps_per_g", recording::number(acceleration)}});
  }
  return {
      .title = "Models of the catalogue",
      .lead = fmt::format(
          "Drift: root mean square of the heading's drift over a drive of {:g} s after a stop of "
          "{:g} s, in {} simulated drives of three axes each.",
          traffic.drive_s, traffic.stop_s, traffic.drives),
      .parts = {{.heading = "Models", .tables = {std::move(table)}}},
      .json = json.dump(2) + "\n"};
}

}  // namespace zerorate::evaluate

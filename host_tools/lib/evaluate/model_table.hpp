/// @file
/// Models beside each other, by the figures by which somebody chooses a sensor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/report/presentation.hpp"

namespace zerorate::evaluate {

/// A vehicle that stops and drives on, again and again, with a node that learns at each stop.
struct StopAndGo {
  double stop_s = 30.0;
  double drive_s = 300.0;
  std::size_t drives = 20;  ///< drives of each of three axes
  double sample_rate_hz = 2.0;
  std::uint64_t seed = 1;
};

/// Figures of one model.
struct ModelFigures {
  std::string name;   ///< name in the catalogue, or of the file
  std::string title;  ///< maker and part
  double angle_random_walk_deg_rt_h = 0.0;
  double allan_floor_dph = 0.0;
  /// Source of the floor, in a word: "stated", "second-hand", "estimated".
  std::string basis;
  double drift_rms_deg = 0.0;    ///< drift of the heading over a drive, over all simulated drives
  double drift_error_deg = 0.0;  ///< standard error of drift_rms_deg by the number of drives
  std::optional<double> scale_percent;            ///< standard deviation over the parts of a kind
  std::optional<double> g_sensitivity_dps_per_g;  ///< standard deviation of a coefficient
};

/// Simulates white noise, 1/f noise and a constant bias of a model, and gives them to a node with
/// that model. Errors of the scale factor and of acceleration are not simulated: the vehicle
/// drives straight and level. Takes a tenth of a second or so.
[[nodiscard]] ModelFigures figures_of(std::string name, const model::SensorModel& model,
                                      const StopAndGo& traffic);

/// A row a model; JSON of the schema zerorate.models/1.
[[nodiscard]] report::Presentation present(const std::vector<ModelFigures>& models,
                                           const StopAndGo& traffic);

}  // namespace zerorate::evaluate

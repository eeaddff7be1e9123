/// @file
/// Calibration of a scale factor by the turns of a guide: its result, and what speaks against it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/calibrate/scale_fit.hpp"
#include "host_tools/lib/calibrate/turn_guide.hpp"

namespace zerorate::calibrate {

struct CalibrationSettings {
  int turns = 10;                ///< full turns of each sense
  double mark_sigma_rad = 0.03;  ///< error of a stop at the mark, standard deviation
  model::ScaleFactor tolerance;  ///< tolerance of the data sheet or of the model
  /// Known errors of x, y and z that the node takes off already; nullopt: its model is not known
  /// here, and what is found comes on top.
  std::optional<std::array<double, 3>> taken_off = std::array<double, 3>{};
  /// Change of the scale factor after the calibration by temperature and age, standard deviation.
  double drift_sigma = 0.002;
};

struct Calibration {
  CalibrationSettings settings;
  std::size_t axis = 0;
  std::vector<GuidedTurn> turns;
  double tilt_rad = 0.0;  ///< largest angle between the axis and that of a turn
  /// Reasons why the turns give no result, each with its cure; empty: `fit` is one.
  std::vector<std::string> problems;
  std::vector<std::string> notes;
  std::optional<ScaleFit> fit;  ///< none without turns, or with a problem

  /// Share that a tilted axis is short of: it measures the cosine.
  [[nodiscard]] double tilt_loss() const { return 1.0 - std::cos(tilt_rad); }
  /// Whether the scale factor is off by more than the data sheet allows, both taken as 95 %
  /// intervals.
  [[nodiscard]] bool contradicts_tolerance() const;
};

/// @param guide at its end
[[nodiscard]] Calibration calibrate(const TurnGuide& guide, const CalibrationSettings& settings);

/// Error of the scale factor of the axis that was turned: what the turns show and what the node
/// took off before they were summed.
/// @param found as the turns show it
[[nodiscard]] double whole_error(const Calibration& calibration, double found);

/// The scale factor of a model after this calibration: the whole error of the axis that was turned
/// as known, and the tolerance of what is left. Other axes keep their errors.
/// @param calibration with a fit
[[nodiscard]] model::ScaleFactor calibrated_scale_factor(const Calibration& calibration);

}  // namespace zerorate::calibrate

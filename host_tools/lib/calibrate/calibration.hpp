/// @file
/// Calibration of a scale factor by the turns of a guide: its result, and what speaks against it.
#pragma once

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
  model::ScaleFactor tolerance;  ///< tolerance of the data sheet
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

/// The scale factor of a model after this calibration. A node corrects no known scale factor, so
/// the tolerance contains the measured error and its standard deviation.
/// @param calibration with a fit
[[nodiscard]] model::ScaleFactor calibrated_scale_factor(const Calibration& calibration);

}  // namespace zerorate::calibrate

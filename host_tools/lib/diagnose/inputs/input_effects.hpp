/// @file
/// Effects of measured inputs on the bias, over all standstills: the acceleration (g sensitivity)
/// and the vibration (rectification).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/inputs/input_regression.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Worth of an effect on the last standstills, predicted by a fit to those before.
struct InputWorth {
  std::size_t standstills = 0;          ///< held out
  double gain_nats_a_standstill = 0.0;  ///< log likelihood by the filter of the node
};

/// Figures of an effect that was found.
struct InputEffect {
  std::string name;                          ///< in the catalogue
  std::vector<double> value_rad_s;           ///< its coefficients, per g on x, y, z or per g^2
  std::vector<double> standard_error_rad_s;  ///< infinite where the record cannot tell
  std::optional<InputWorth> worth{};         ///< nothing where too little is left for a fit

  /// True if the node's model is to have it.
  [[nodiscard]] bool pays() const { return !worth || worth->gain_nats_a_standstill > 0.0; }
};

/// Effects of the inputs on one axis.
struct InputFindings {
  std::vector<InputEffect> effects;  ///< strongest first
  std::vector<Cause> causes;         ///< one an effect
  std::vector<SelectionEvidence> evidence;
  std::vector<std::string> remarks;  ///< reasons why an effect cannot be told
  /// Share of the vibration in the bias, one a tick; none where that effect was not found.
  std::vector<double> vibration_share_rad_s;
};

struct InputSearchOptions {
  double threshold_nats = 8.1;  ///< surprisal from which on an effect is named
  double holdout = 0.3;         ///< share at the end on which its worth is measured
};

/// Searches the effects of the inputs; nothing where there are no ticks.
/// @param axis  of the rates
[[nodiscard]] InputFindings find_input_effects(const InputTicks& ticks, std::size_t axis,
                                               const InputSearchOptions& options = {});

/// Adds the effects that pay to the model of the node, as inputs with known coefficients.
/// @param axis  of the rates; nothing: the sensor has one axis, which stands for all
void add_inputs_to_model(const InputFindings& findings, std::optional<std::size_t> axis,
                         model::SensorModel& model);

/// Takes the share of the vibration off the rates of a record, which keeps its level, so that no
/// function of time is found in its place. The attitude of a standstill does not change.
void take_off_vibration(const InputFindings& findings, Record& record);

}  // namespace zerorate::diagnose

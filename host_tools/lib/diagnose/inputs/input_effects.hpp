/// @file
/// Effects of measured inputs on the bias, over all standstills: the acceleration (g sensitivity)
/// and the vibration (rectification).
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "host_tools/lib/diagnose/inputs/input_regression.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

using Direction = std::array<double, 3>;  ///< unit vector in sensor axes

/// Directions in which the acceleration of the standstills differs.
struct Attitudes {
  std::vector<Direction> directions;  ///< at right angles, the one of most change first
  std::size_t standstills = 0;
};

/// Directions along which the mean accelerations of the standstills scatter by at least
/// kLeastSpread_g: along the others a sensitivity and a constant bias are one.
[[nodiscard]] Attitudes attitudes_of(const InputTicks& ticks);
inline constexpr double kLeastSpread_g = 0.1;  ///< rms; some 6 deg of tilt each way

/// Figures of an effect that was found.
struct InputEffect {
  std::string name;                          ///< in the catalogue
  std::vector<double> value_rad_s;           ///< its coefficients, per g on x, y, z or per g^2
  std::vector<double> standard_error_rad_s;  ///< infinite where the record cannot tell
};

/// What the inputs of one axis explain.
struct InputFindings {
  std::vector<InputEffect> effects;  ///< strongest first
  std::vector<Cause> causes;         ///< one an effect
  std::vector<SelectionEvidence> evidence;
  std::vector<std::string> remarks;  ///< reasons why an effect cannot be told
  /// Share of the vibration in the bias, one a tick; none where that effect was not found.
  std::vector<double> vibration_share_rad_s;
};

/// Searches the effects of the inputs; nothing where there are no ticks.
/// @param axis  of the rates
/// @param threshold_nats  surprisal from which on an effect is named
[[nodiscard]] InputFindings find_input_effects(const InputTicks& ticks, std::size_t axis,
                                               double threshold_nats);

/// Takes the share of the vibration off the rates of a record, which keeps its level, so that no
/// function of time is found in its place. The attitude of a standstill does not change.
void take_off_vibration(const InputFindings& findings, Record& record);

}  // namespace zerorate::diagnose

/// @file
/// A calibration by turns as text: while it goes on, and at its end.
#pragma once

#include <string>

#include "host_tools/lib/calibrate/calibration.hpp"
#include "host_tools/lib/calibrate/turn_guide.hpp"

namespace zerorate::calibrate {

/// The next thing to do, and how far it is, in less than 70 characters.
[[nodiscard]] std::string instruction(const TurnGuide& guide, const TurnGuide::Settings& settings,
                                      int turns);

/// Figures, notes and the table for a model file; the calibration must have a fit.
[[nodiscard]] std::string to_text(const Calibration& calibration);

/// Schema zerorate.calibrate-turns/1.
[[nodiscard]] std::string to_json(const Calibration& calibration);

}  // namespace zerorate::calibrate

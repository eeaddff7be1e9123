/// @file
/// Figures of effects: parameters with their intervals, and what the node's model takes of them.
#pragma once

#include <string>

#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// A positive parameter with the interval value * exp(+-1.96 log_error).
/// @param log_error  standard error of the logarithm
[[nodiscard]] Parameter positive_parameter(std::string name, double value, double log_error);

/// A parameter with the interval value +- 1.96 standard_error.
[[nodiscard]] Parameter parameter(std::string name, double value, double standard_error);

/// Filter tick of the node when it runs a model of this record [s].
[[nodiscard]] double node_tick_s(const FitData& data);

/// Standard deviation of a transient's or a ramp's size at the next start, relative to its size.
inline constexpr double kShareOfNextStart = 0.3;

}  // namespace zerorate::diagnose

/// @file
/// Parameters with a 95 % interval from a standard error.
#pragma once

#include <string>

#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// A positive parameter with the interval value * exp(+-1.96 log_error).
/// @param log_error  standard error of the logarithm
[[nodiscard]] Parameter positive_parameter(std::string name, double value, double log_error);

/// A parameter with the interval value +- 1.96 standard_error.
[[nodiscard]] Parameter parameter(std::string name, double value, double standard_error);

}  // namespace zerorate::diagnose

/// @file
/// Names, figures and sentences of the effects of inputs.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

struct InputEffect;

inline constexpr std::string_view kGSensitivity = "g_sensitivity";
inline constexpr std::string_view kVibrationRectification = "vibration_rectification";

/// Scatter of the biases of the standstills about their mean, rms.
struct Spread {
  double before_rad_s = 0.0;
  double after_rad_s = 0.0;  ///< without the share of an input
  std::size_t standstills = 0;
};

/// Coefficients with their 95 % intervals, in deg/s per g or g^2; an axis that the record cannot
/// tell has none.
[[nodiscard]] std::vector<Parameter> parameters_of(const InputEffect& effect);

[[nodiscard]] std::string sentence_of(const InputEffect& effect, const Spread& spread);

/// Reason why the model of the node leaves an effect out; empty where it has it.
[[nodiscard]] std::string reason_to_leave_out(const InputEffect& effect);

inline constexpr std::string_view kSourceOfInputs =
    "identified over all standstills of a recording by zerorate diagnose";

/// Reason why the attitudes of a record show no sensitivity to acceleration, and the cure.
[[nodiscard]] std::string remark_on(std::size_t standstills);

}  // namespace zerorate::diagnose

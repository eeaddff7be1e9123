/// @file
/// Export of a hypothesis as a model that the node runs.
#pragma once

#include <span>
#include <string>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"

namespace zerorate::diagnose {

/// White and flicker noise of a hypothesis, extended by its effects.
[[nodiscard]] model::SensorModel model_of(const Hypothesis& hypothesis,
                                          std::span<const Choice> choices,
                                          const std::string& source);

}  // namespace zerorate::diagnose

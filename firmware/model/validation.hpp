/// @file
/// Whether a model that was put together in code could also have been read from a file.
#pragma once

#include "firmware/model/sensor_model.hpp"

namespace zerorate::model {

/// Throws std::invalid_argument, which names the field and what was expected, where a number is
/// impossible: negative, not finite, an order outside (0, 1), ...
void validate(const SensorModel& model);
void validate(const Flicker& flicker);

}  // namespace zerorate::model

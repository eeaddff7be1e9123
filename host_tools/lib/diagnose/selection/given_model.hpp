/// @file
/// A model that is given and not fitted, as a hypothesis about a record.
#pragma once

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"

namespace zerorate::diagnose {

/// The noise of the model as it stands: white noise with that of its steps, flicker noise, random
/// walk, Gauss-Markov processes and lines. What the node learns anew at each start, warm-up, ramp
/// and the share of the temperature (if the record has one), is fitted in size.
[[nodiscard]] Hypothesis hypothesis_of(const FitData& data, const model::SensorModel& model);

/// Whether effects that were fitted, beside white and flicker noise of any strength, gain no more
/// than chance over the hypothesis of the model. False where one of them neither changes the
/// spectrum nor the mean, and is no rounding that the model has.
[[nodiscard]] bool is_enough(const Hypothesis& given, const model::SensorModel& model,
                             const Hypothesis& fitted);

}  // namespace zerorate::diagnose
